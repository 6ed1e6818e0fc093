#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace wct {

/// The numbers of a text, which blanks part.
template <class Number> struct NumberText {
    std::vector<Number> values;
    std::vector<std::int64_t> widths; ///< how many there are in each line that is read
    std::size_t end = 0;              ///< where reading ended
    bool good = true;                 ///< false where it ended at a word that is no such number
};

/// What of a text is read.
struct NumberPlaces {
    std::size_t start = 0;                                       ///< from here on
    std::size_t lines = std::numeric_limits<std::size_t>::max(); ///< so many lines
    std::string_view head; ///< of lines that begin with this word, in small letters or capitals, what is behind it
    char stop = '\0';      ///< of each word what is before this letter
};

/// Read the numbers of a text, rounded to nearest; exponents may be Fortran's D, and a whole number may have a point.
///
/// Without a head all lines are read that have any word.
template <class Number> NumberText<Number> read_numbers(std::string_view text, const NumberPlaces &places);

extern template NumberText<double> read_numbers<double>(std::string_view, const NumberPlaces &);
extern template NumberText<std::int64_t> read_numbers<std::int64_t>(std::string_view, const NumberPlaces &);

} // namespace wct
