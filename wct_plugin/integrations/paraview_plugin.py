"""A plugin for ParaView: every filter of a pipeline, and every maker of meshes, in its menus, made of its declaration.

Load this file in ParaView under Tools, Manage Plugins, Load New; its Python must have wct_plugin and pyvista. Under
plain VTK the classes are algorithms as any other:

>>> from wct_plugin.integrations.paraview_plugin import MeshingWellCentered  # doctest: +SKIP
>>> filter = MeshingWellCentered()  # doctest: +SKIP
>>> filter.SetInputDataObject(grid)  # doctest: +SKIP
>>> filter.SetGoal("3wc")  # doctest: +SKIP
>>> filter.Update()  # doctest: +SKIP

What a filter found out is in the field data ``metrics`` of what it gives, as JSON.
"""

import json
from collections.abc import Callable
from typing import Any, ClassVar, Literal, get_args, get_origin
from xml.sax.saxutils import escape, quoteattr

import pyvista as pv
from pydantic.fields import FieldInfo
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkDataObject

from wct_plugin.errors import WctError, one_line
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.conversions import as_mesh
from wct_plugin.objects.pyvista_meshes import to_pyvista, without_field_data
from wct_plugin.pipeline.provenance import plain
from wct_plugin.pipeline.stage import FilterStage, Kind, Options, filter_names, find_filter
from wct_plugin.pipeline.stage_page import choices
from wct_plugin.progress import Progress

try:
    from paraview.util.vtkAlgorithm import smdomain, smhint, smproperty, smproxy
except ImportError:  # plain VTK, which has no menus
    smproxy = None

_DATA: dict[Kind, str] = {TetMesh: "vtkUnstructuredGrid", SurfaceMesh: "vtkPolyData"}
_METRICS = "metrics"
#: ParaView's elements for an option, by its type; any other is typed as text.
_ELEMENTS = {bool: "IntVectorProperty", int: "IntVectorProperty", float: "DoubleVectorProperty"}


class FilterAlgorithm(VTKPythonAlgorithmBase):
    """One filter as a VTK algorithm; each option has a setter, ``SetMaxTets`` for ``max_tets``."""

    stage: ClassVar[type[FilterStage[Options]]]

    def __init__(self) -> None:
        takes, gives = self.stage.takes, self.stage.gives
        super().__init__(  # type: ignore[no-untyped-call]  # VTK's
            nInputPorts=0 if takes is None else 1,
            inputType=_DATA[takes or TetMesh],
            nOutputPorts=1,
            outputType=_DATA[gives],
        )
        self._given: dict[str, Any] = {}
        self._regions: list[str] = []

    def set_option(self, name: str, value: Any) -> None:
        """Set an option; an empty text leaves it as it is declared."""
        self._given.pop(name, None)
        if value != "":
            self._given[name] = value
        self.Modified()

    def SetRegions(self, names: str) -> None:  # noqa: N802
        """Say what the regions are: an array of whole numbers, or names of sets with commas between."""
        self._regions = [name.strip() for name in names.split(",") if name.strip()]
        self.Modified()

    def RequestData(self, _request: Any, inputs: Any, outputs: Any) -> int:  # noqa: N802
        """Run the filter; what was wrong is said in ParaView's window of messages."""
        try:
            made, metrics = self.stage(**self._given)(self._read(inputs), self._tell)
        except WctError as error:
            vtkOutputWindow.GetInstance().DisplayErrorText(f"{self.stage.type()}: {one_line(error)}\n")
            return 0
        dataset = to_pyvista(made)
        found = vtkStringArray()
        found.SetName(_METRICS)
        found.InsertNextValue(json.dumps(plain(metrics)))
        dataset.GetFieldData().AddArray(found)
        vtkDataObject.GetData(outputs, 0).ShallowCopy(dataset)
        return 1

    def _read(self, inputs: Any) -> TetMesh | SurfaceMesh | None:
        if self.stage.takes is None:
            return None
        given = without_field_data(pv.wrap(vtkDataObject.GetData(inputs[0], 0)))  # so without those of a filter before
        names = self._regions
        return as_mesh(given, regions=(names[0] if len(names) == 1 else names) or None)

    def _tell(self, progress: Progress) -> bool:
        self.SetProgressText(progress.stage)
        self.UpdateProgress(progress.done)
        return not self.GetAbortExecute()


def _algorithm(stage: type[FilterStage[Options]]) -> type[FilterAlgorithm]:
    """The class of a filter's algorithm, called as the filter's own."""
    setters = {f"Set{_camel(name)}": _setter(name) for name in _options(stage)}
    members = {"stage": stage, "__doc__": stage.__doc__, "__module__": __name__, **setters}
    return type(_camel(stage.name), (FilterAlgorithm,), members)


def _setter(name: str) -> Callable[[FilterAlgorithm, Any], None]:
    return lambda self, value: self.set_option(name, value)


def _options(stage: type[FilterStage[Options]]) -> dict[str, FieldInfo]:
    """Those that a line of text or a number can say."""
    found = stage.declaration.model_fields.items()
    return {name: field for name, field in found if get_origin(field.annotation) is not dict}


def _camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def property_xml(name: str, field: FieldInfo) -> str:
    """An option as ParaView's panel shows it."""
    kind: Any = field.annotation
    element = _ELEMENTS.get(kind, "StringVectorProperty")
    default = field.get_default(call_default_factory=True, validated_data={})
    simple = kind in _ELEMENTS or get_origin(kind) is Literal
    shown = "" if field.is_required() or default is None or not (simple or isinstance(default, str)) else default
    domain = ""
    if kind is bool:
        shown, domain = int(shown), '<BooleanDomain name="bool"/>'
    elif get_origin(kind) is Literal and choices(field):
        entries = "".join(f"<String value={quoteattr(str(choice))}/>" for choice in get_args(kind))
        domain = f'<StringListDomain name="list">{entries}</StringListDomain>'
    label = name.replace("_", " ").capitalize()
    return (
        f'<{element} name={quoteattr(_camel(name))} label={quoteattr(label)} command="Set{_camel(name)}" '
        f'number_of_elements="1" default_values={quoteattr(str(shown))}>{domain}'
        f"<Documentation>{escape(field.description or '')}</Documentation></{element}>"
    )


def _in_menus(algorithm: type[FilterAlgorithm]) -> Any:
    """What ParaView finds in this module: the class with the description of its panel."""
    stage = algorithm.stage
    label = f"WCT {stage.name.replace('_', ' ')}"
    panel = "".join(property_xml(name, field) for name, field in _options(stage).items())
    if stage.takes is TetMesh:
        panel += (
            '<StringVectorProperty name="Regions" command="SetRegions" number_of_elements="1" default_values="">'
            "<Documentation>Array of whole numbers that the regions are, or names of sets of tets</Documentation>"
            "</StringVectorProperty>"
        )
    made: Any = algorithm
    if panel:
        made = smproperty.xml(panel)(made)
    made = smhint.xml('<ShowInMenu category="Well-centered tets"/>')(made)
    if stage.takes is None:
        return smproxy.source(name=algorithm.__name__, label=label)(made)
    made = smproperty.input(name="Input")(smdomain.datatype([_DATA[stage.takes]], composite_data_supported=False)(made))
    return smproxy.filter(name=algorithm.__name__, label=label)(made)


for _name in filter_names():
    _made = _algorithm(find_filter(_name))
    globals()[_made.__name__] = _made if smproxy is None else _in_menus(_made)
