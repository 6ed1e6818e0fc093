"""What halves and doubles the core's numbers finds them all, and leaves what is no number of an option struct."""

from pathlib import Path

from benchmarks import numbers

HEADER = """struct FitForm {
    double weight = 0.1; // of what
    static constexpr int rounds = 20;
    double nothing = 0.0;
    bool sharp = true;
};
class Fit {
    static constexpr double kFar = 3.0;
};
"""


def test_numbers_of_option_structs_are_asked_for():
    text, found = numbers.asked_for(HEADER)
    assert [(one.name, one.value) for one in found] == [("FitForm.weight", "0.1"), ("FitForm.rounds", "20")]
    assert '    double weight = ::wct_numbers::asked<double>("FitForm.weight", 0.1); // of what\n' in text
    assert '    static inline const int rounds = ::wct_numbers::asked<int>("FitForm.rounds", 20);\n' in text
    assert "static constexpr double kFar = 3.0;" in text
    assert "double nothing = 0.0;" in text


def test_the_table_of_the_documents_has_every_number():
    cpp = Path(__file__).parents[2] / "cpp"
    table = (Path(__file__).parents[2] / "docs" / "numbers.md").read_text(encoding="utf-8")
    cells = [[cell.strip() for cell in line.split("|")] for line in table.splitlines() if line.startswith("| ")]
    rows = {row[1]: row[2] for row in cells}
    for name in numbers.HEADERS:
        for one in numbers.asked_for((cpp / name).read_text(encoding="utf-8"))[1]:
            assert rows[one.name] == one.value, one
