"""modelDescription.xml of FMI 2.0, which counts variables from 1."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any
from xml.etree import ElementTree

from ....units.parse import coherent_unit
from .programs import THROUGH, TORQUE, Programs
from .variables import NOMINAL, Variable, Variables

Dependencies = Mapping[str, tuple[str, ...]]  # of each unknown, by name
STARTS = {"theta": "theta0", "omega": "omega_start"}  # the parameters of the states


def description(name: str, head: dict[str, str], table: Variables, made: Programs, token: str) -> str:
    """The text of the file."""
    counted = {"numberOfEventIndicators": str(table.indicators)}
    root = ElementTree.Element("fmiModelDescription", {"fmiVersion": "2.0", "guid": token} | head | counted)
    common = {
        "modelIdentifier": name, "canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }  # fmt: skip
    for tag in ("ModelExchange", "CoSimulation"):
        more = {"canHandleVariableCommunicationStepSize": "true"} if tag == "CoSimulation" else {}
        files = ElementTree.SubElement(ElementTree.SubElement(root, tag, common | more), "SourceFiles")
        ElementTree.SubElement(files, "File", name=f"{name}.c")
    group = ElementTree.SubElement(root, "UnitDefinitions")
    for unit in dict.fromkeys(row.unit for row in table.rows if row.unit != "1"):
        powers = {base: str(n) for base, n in coherent_unit(unit)._asdict().items() if n and base != "name"}
        ElementTree.SubElement(ElementTree.SubElement(group, "Unit", name=unit), "BaseUnit", powers)
    group = ElementTree.SubElement(root, "LogCategories")
    for category, meaning in (("logStatusError", "what is wrong"), ("logEvents", "why a simulation ends")):
        ElementTree.SubElement(group, "Category", name=category, description=meaning)
    _variables(ElementTree.SubElement(root, "ModelVariables"), table)
    _structure(ElementTree.SubElement(root, "ModelStructure"), table, _dependencies(table, made))
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _variables(body: Any, table: Variables) -> None:
    index = {name: str(place + 1) for name, place in table.place.items()}
    for row in table.rows:
        about = {"name": row.name, "valueReference": str(table.place[row.name]), "description": row.meaning}
        about |= {"causality": row.causality, "variability": row.variability} | _initial(row)
        value = {"unit": row.unit} if row.unit != "1" and not row.whole else {}
        value |= {"derivative": index[row.derivative]} if row.derivative else {}
        value |= {"start": repr(row.start)} if row.start is not None else {}
        value |= {"nominal": repr(NOMINAL)} if row.name in table.states else {}
        kind = "Integer" if row.whole else "Real"
        ElementTree.SubElement(ElementTree.SubElement(body, "ScalarVariable", about), kind, value)


def _initial(row: Variable) -> dict[str, str]:
    how = {"parameter": "exact", "output": "calculated", "local": "calculated"}.get(row.causality)
    return {"initial": how} if how else {}


def _structure(structure: Any, table: Variables, known: Dependencies) -> None:
    outputs = [row.name for row in table.rows if row.causality == "output"]
    derivatives = [row.name for row in table.rows if row.derivative]
    index = {name: str(place + 1) for name, place in table.place.items()}

    def add(tag: str, names: Sequence[str], by: Mapping[str, Iterable[str]]) -> None:
        group = ElementTree.Element(tag)
        if names:
            structure.append(group)
        for unknown in names:
            places = {"index": index[unknown], "dependencies": " ".join(index[n] for n in by[unknown])}
            ElementTree.SubElement(group, "Unknown", places)

    changing = {"time", *table.inputs, *table.states}  # the knowns outside of initialisation mode
    now = {n: [by for by in known[n] if by in changing] for n in known} | {n: [n] for n in table.states}
    add("Outputs", outputs, now)
    add("Derivatives", derivatives, now)
    unknowns = list(dict.fromkeys([*outputs, *table.states, *derivatives]))
    add("InitialUnknowns", unknowns, {n: _of_start(n, table, known) for n in unknowns})


def _of_start(name: str, table: Variables, known: Dependencies) -> tuple[str, ...]:
    """The knowns of an unknown in initialisation mode: the states are those of their parameters."""
    if name in table.states:
        return (STARTS[name],)
    own = {STARTS[n] if n in table.states else n for n in known[name]} - {"time"}
    return tuple(n for n in (*table.parameters, *table.inputs) if n in own)


def _dependencies(table: Variables, made: Programs) -> Dependencies:
    """The knowns of outputs and derivatives: inputs, states, parameters, and time where a speed is given."""
    moves = bool(table.states)
    by_row: dict[str, set[str]] = {}
    for row, by in made.entries:
        through = {p for table in made.tables.get(by, {}).values() for p in table.parameters}
        by_row.setdefault(row, set()).update({by}, through & {*THROUGH})
    # The acceleration depends on what T_in does; where friction acts, on the way of turning, too.
    alpha = (by_row.get(TORQUE, set()) | {"torque"}) - {"alpha"} if moves else set()
    result: dict[str, set[str]] = {} if moves else {"theta": {"theta0", "omega", "time"}}
    for row in (*table.outputs, *(["der(theta)", "der(omega)"] if moves else [])):
        own = {"omega"} if row == "der(theta)" else alpha if row == "der(omega)" else set(by_row.get(row, ()))
        if row == "status":
            own = set(made.outputs.inputs) | ({"alpha"} if moves else set())
        own = (own - {"alpha"}) | alpha if "alpha" in own else own
        result[row] = own if moves or "theta" not in own else own | {"theta0", "omega", "time"}
    order = ("time", *table.parameters, *table.inputs, *table.states)
    return {name: tuple(n for n in order if n in own) for name, own in result.items()}
