"""``wct.Filter`` and its kin: every registered filter with a real signature and docstring."""

import inspect

import pytest
from support.builders import jittered_cube

import wct_plugin as wct
from wct_plugin.errors import OptionError
from wct_plugin.pipeline.stage import filter_names, find_filter


@pytest.mark.parametrize("name", filter_names())
def test_signature_and_docstring_come_from_the_declaration(name):
    fields = find_filter(name).declaration.model_fields
    inputs = [] if find_filter(name).starts() else ["inputs"]
    construct = getattr(wct.Filter, name)
    parameters = inspect.signature(construct).parameters
    assert list(parameters) == [*fields, "tag", *inputs]
    assert {one.kind for one in parameters.values()} == {inspect.Parameter.KEYWORD_ONLY}
    for option, field in fields.items():
        if field.is_required():
            assert parameters[option].default is inspect.Parameter.empty
        elif field.default_factory is None:
            assert parameters[option].default == field.default
        assert parameters[option].annotation is not inspect.Parameter.empty
        assert f"\n{option} : " in construct.__doc__
        assert field.description in construct.__doc__
    assert construct.__doc__.startswith(find_filter(name).summary())
    assert construct.__name__ == name


def test_a_signature_in_full():
    signature = inspect.signature(wct.Filter.get_quality)
    shown = [(one.name, one.default) for one in signature.parameters.values()]
    assert shown == [("worst", 10), ("tag", ""), ("inputs", ())]
    assert signature.return_annotation is wct.Pipeline
    assert (
        "\nworst : int, >= 0, default 10\n    How many of the worst tets to list.\n" in wct.Filter.get_quality.__doc__
    )


def test_they_are_listed():
    assert dir(wct.Filter) == filter_names()
    assert dir(wct.Reader) == ["mesh"]
    assert dir(wct.Writer) == ["dual", "mesh", "report"]


def test_names_that_are_none():
    with pytest.raises(AttributeError, match=r"there is no filters.get_qualty; did you mean 'get_quality'\?"):
        _ = wct.Filter.get_qualty
    with pytest.raises(AttributeError, match=r"there is no writers.reports; did you mean 'report'\?"):
        _ = wct.Writer.reports
    assert not hasattr(wct.Reader, "report")


def test_options_are_checked_at_once_and_by_name_only():
    with pytest.raises(OptionError, match=r"filters.get_quality: unknown option 'wurst'; did you mean 'worst'"):
        wct.Filter.get_quality(wurst=3)
    with pytest.raises(OptionError, match=r"filters.get_quality takes its options by name only"):
        wct.Filter.get_quality(3)
    with pytest.raises(OptionError, match=r"readers.mesh: option 'filename' is 3; must be the name of a mesh file"):
        wct.Reader(3)


def test_files_become_the_stage_their_name_asks_for(tmp_path):
    kinds = [
        wct.Reader(tmp_path / "a.json"),
        wct.Writer(tmp_path / "a.json"),
        wct.Writer("a.vtu"),
        wct.Writer("a.HTML"),
    ]
    assert [str(one) for one in kinds] == [
        "<Pipeline readers.mesh>", "<Pipeline writers.report>", "<Pipeline writers.mesh>", "<Pipeline writers.report>",
    ]  # fmt: skip
    (step,) = wct.Writer.report(filename="numbers.txt", format="json", worst=1, tag="r", inputs="a").steps
    assert (step.tag, step.inputs, step.stage.options.worst) == ("r", ("a",), 1)


def test_a_mesh_in_memory_is_read_as_it_is():
    mesh = jittered_cube(2, 0)
    assert wct.Reader(mesh).execute().mesh is mesh
