#include "base/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>

namespace wct {

namespace {

/// Whole numbers up to this one have their own double.
constexpr double kWhole = 9007199254740992.0;

bool blank(char c) {
    return static_cast<unsigned char>(c) <= ' ';
}

const char *behind_blanks(const char *at, const char *end) {
    while (at != end && blank(*at))
        ++at;
    return at;
}

/// Whether the first word of a line is `head`, which has small letters only.
bool begins_with(const char *at, const char *end, std::string_view head) {
    if (static_cast<std::size_t>(end - at) < head.size())
        return false;
    for (const char c : head)
        if (const char own = *at++; own != c && own != c - 'a' + 'A')
            return false;
    return at == end || blank(*at);
}

/// By the C library: what the fast way does not take, as Fortran's exponents and what under- or overflows.
std::optional<double> read_slowly(std::string_view word) {
    std::string copy(word);
    if (copy.find_first_of("xX") != std::string::npos) // no hexadecimal ones
        return std::nullopt;
    for (char &c : copy)
        if (c == 'd' || c == 'D')
            c = 'e';
    char *end = nullptr;
    const double value = std::strtod(copy.c_str(), &end);
    if (copy.empty() || end != copy.c_str() + copy.size())
        return std::nullopt;
    return value;
}

/// The fast way takes a minus only.
std::string_view without_plus(std::string_view word) {
    return word.size() > 1 && word[0] == '+' && word[1] != '-' ? word.substr(1) : word;
}

std::optional<double> read_word(std::string_view word, double) {
#if defined(__cpp_lib_to_chars) && __cpp_lib_to_chars >= 201611L
    const std::string_view digits = without_plus(word);
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc() && end == digits.data() + digits.size())
        return value;
#endif
    return read_slowly(word);
}

std::optional<std::int64_t> read_word(std::string_view word, std::int64_t) {
    const std::string_view digits = without_plus(word);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc() && end == digits.data() + digits.size())
        return value;
    const auto real = read_word(word, 0.0);
    if (!real || !(std::abs(*real) <= kWhole) || *real != std::trunc(*real))
        return std::nullopt;
    return static_cast<std::int64_t>(*real);
}

} // namespace

template <class Number> NumberText<Number> read_numbers(std::string_view text, const NumberPlaces &places) {
    NumberText<Number> out;
    const std::string_view head = places.head;
    const char *at = text.data() + std::min(places.start, text.size()), *const end = text.data() + text.size();
    while (at != end && out.widths.size() < places.lines) {
        const void *feed = std::memchr(at, '\n', static_cast<std::size_t>(end - at));
        const char *const close = feed ? static_cast<const char *>(feed) : end;
        at = behind_blanks(at, close);
        const bool read = head.empty() ? at != close : begins_with(at, close, head);
        std::int64_t width = 0;
        if (read)
            at += head.size();
        while (read && (at = behind_blanks(at, close)) != close) {
            const char *const word = at;
            while (at != close && !blank(*at))
                ++at;
            std::string_view number(word, static_cast<std::size_t>(at - word));
            if (places.stop)
                number = number.substr(0, number.find(places.stop));
            const auto value = read_word(number, Number());
            if (!value) {
                out.end = static_cast<std::size_t>(word - text.data());
                out.good = false;
                return out;
            }
            out.values.push_back(*value);
            ++width;
        }
        if (read)
            out.widths.push_back(width);
        at = close == end ? end : close + 1;
    }
    out.end = static_cast<std::size_t>(at - text.data());
    return out;
}

template NumberText<double> read_numbers<double>(std::string_view, const NumberPlaces &);
template NumberText<std::int64_t> read_numbers<std::int64_t>(std::string_view, const NumberPlaces &);

} // namespace wct
