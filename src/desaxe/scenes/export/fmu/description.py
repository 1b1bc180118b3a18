"""modelDescription.xml and buildDescription.xml, for FMI 3.0 and FMI 2.0."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any
from xml.etree import ElementTree

from ....units.parse import coherent_unit
from .programs import TORQUE, Programs
from .variables import NOMINAL, Variable, Variables

Dependencies = Mapping[str, tuple[str, ...]]  # of each unknown, by name


def dependencies(table: Variables, made: Programs) -> dict[str, tuple[str, ...]]:
    """The knowns of outputs and derivatives: inputs, states, parameters, and time where a speed is given."""
    order = [*table.parameters, *table.inputs, *table.states]
    moves = bool(table.states)
    by_row: dict[str, set[str]] = {}
    for row, by in made.entries:
        through = made.loads[by].parameters if by in made.loads else ()
        by_row.setdefault(row, set()).update((by, *through))
    # The acceleration depends on what T_in does; where friction acts, on the way of turning, too.
    alpha = (by_row.get(TORQUE, set()) | {"torque"}) - {"alpha"} if moves else set()
    found: dict[str, set[str]] = {}
    for row in (*table.outputs, *(["der(theta)", "der(omega)"] if moves else [])):
        own = {"omega"} if row == "der(theta)" else alpha if row == "der(omega)" else set(by_row.get(row, ()))
        if row == "status":
            own = set(made.outputs.inputs) | ({"alpha"} if moves else set())
        own = (own - {"alpha"}) | alpha if "alpha" in own else own
        found[row] = own if moves or "theta" not in own else own | {"theta0", "omega", "time"}
    if not moves:
        found["theta"] = {"theta0", "omega", "time"}
    return {name: tuple(n for n in ["time", *order] if n in own) for name, own in found.items()}


def initial(name: str, table: Variables, known: Dependencies) -> tuple[str, ...]:
    """The knowns of an unknown in initialisation mode: the states are those of their parameters."""
    if table.states and name in table.states:
        return ({"theta": "theta0", "omega": "omega_start"}[name],)
    start = {"theta": "theta0", "omega": "omega_start"} if table.states else {}
    own = {start.get(n, n) for n in known[name]} - {"time"}
    return tuple(n for n in (*table.parameters, *table.inputs) if n in own)


def unknowns(table: Variables) -> dict[str, list[str]]:
    """The names of each list of the model structure."""
    outputs = [row.name for row in table.rows if row.causality == "output"]
    derivatives = [row.name for row in table.rows if row.derivative]
    return {
        "outputs": outputs,
        "derivatives": derivatives,
        "initial": list(dict.fromkeys([*outputs, *table.states, *derivatives])),
    }


# ---- FMI 3.0 ----------------------------------------------------------------------------------------


def description3(name: str, head: dict[str, str], table: Variables, made: Programs, token: str) -> str:
    """The text for FMI 3.0."""
    root = ElementTree.Element(
        "fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": token} | head
    )
    common = {
        "modelIdentifier": name, "canGetAndSetFMUState": "true", "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
    }  # fmt: skip
    ElementTree.SubElement(root, "ModelExchange", common)
    ElementTree.SubElement(root, "CoSimulation", common | {"canHandleVariableCommunicationStepSize": "true"})
    _units(root, table)
    _categories(root)
    place, body = table.place, ElementTree.SubElement(root, "ModelVariables")
    for row in table.rows:
        given = {"name": row.name, "valueReference": str(place[row.name]), "description": row.meaning}
        given |= _role(row)
        if not row.whole:
            given |= {"unit": row.unit} if row.unit != "1" else {}
            given |= {"derivative": str(place[row.derivative])} if row.derivative else {}
            given |= {"start": repr(row.start)} if row.start is not None else {}
            given |= {"nominal": repr(NOMINAL)} if row.name in table.states else {}
        ElementTree.SubElement(body, "Int32" if row.whole else "Float64", given)
    known, lists = dependencies(table, made), unknowns(table)
    structure = ElementTree.SubElement(root, "ModelStructure")

    def add(tag: str, name: str, by: Iterable[str]) -> None:
        places = " ".join(str(place[n]) for n in by)
        ElementTree.SubElement(structure, tag, {"valueReference": str(place[name]), "dependencies": places})

    for output in lists["outputs"]:
        add("Output", output, (output,) if output in table.states else known[output])
    for derivative in lists["derivatives"]:
        add("ContinuousStateDerivative", derivative, known[derivative])
    for unknown in lists["initial"]:
        add("InitialUnknown", unknown, initial(unknown, table, known))
    for zero in table.indicators:
        ElementTree.SubElement(structure, "EventIndicator", {"valueReference": str(place[zero])})
    return _text(root)


def build_description(name: str) -> str:
    """The text that tells an importer how to build an FMU of FMI 3.0."""
    root = ElementTree.Element("fmiBuildDescription", fmiVersion="3.0")
    how = ElementTree.SubElement(root, "BuildConfiguration", modelIdentifier=name)
    files = ElementTree.SubElement(how, "SourceFileSet", language="C99")
    ElementTree.SubElement(files, "SourceFile", name=f"{name}.c")
    return _text(root)


# ---- FMI 2.0 ----------------------------------------------------------------------------------------


def description2(name: str, head: dict[str, str], table: Variables, made: Programs, token: str) -> str:
    """The text for FMI 2.0, which counts variables from 1."""
    counted = {"numberOfEventIndicators": str(len(table.indicators))}
    root = ElementTree.Element("fmiModelDescription", {"fmiVersion": "2.0", "guid": token} | head | counted)
    common = {
        "modelIdentifier": name, "canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }  # fmt: skip
    for tag in ("ModelExchange", "CoSimulation"):
        more = {"canHandleVariableCommunicationStepSize": "true"} if tag == "CoSimulation" else {}
        files = ElementTree.SubElement(ElementTree.SubElement(root, tag, common | more), "SourceFiles")
        ElementTree.SubElement(files, "File", name=f"{name}.c")
    _units(root, table)
    _categories(root)
    place, body = table.place, ElementTree.SubElement(root, "ModelVariables")
    rows = [row for row in table.rows if row.name not in table.indicators]
    index = {row.name: number for number, row in enumerate(rows, 1)}
    for row in rows:
        given = {
            "name": row.name,
            "valueReference": str(place[row.name]),
            "description": row.meaning,
        } | _role(row)
        given |= {"initial": "exact"} if row.causality == "parameter" else {}
        value = {"unit": row.unit} if row.unit != "1" and not row.whole else {}
        value |= {"derivative": str(index[row.derivative])} if row.derivative else {}
        value |= {"start": repr(row.start)} if row.start is not None else {}
        value |= {"nominal": repr(NOMINAL)} if row.name in table.states else {}
        ElementTree.SubElement(
            ElementTree.SubElement(body, "ScalarVariable", given), "Integer" if row.whole else "Real", value
        )
    known, lists = dependencies(table, made), unknowns(table)
    structure = ElementTree.SubElement(root, "ModelStructure")
    changing = {"time", *table.inputs, *table.states}  # the knowns outside of initialisation mode

    def add(tag: str, names: Sequence[str], of: Mapping[str, Iterable[str]]) -> None:
        if names:
            group = ElementTree.SubElement(structure, tag)
            for unknown in names:
                places = " ".join(str(index[n]) for n in of[unknown])
                ElementTree.SubElement(
                    group, "Unknown", {"index": str(index[unknown]), "dependencies": places}
                )

    now = {n: [by for by in known[n] if by in changing] for n in known} | {n: [n] for n in table.states}
    add("Outputs", lists["outputs"], now)
    add("Derivatives", lists["derivatives"], now)
    add("InitialUnknowns", lists["initial"], {n: initial(n, table, known) for n in lists["initial"]})
    return _text(root)


# ---- of both ----------------------------------------------------------------------------------------


def _role(row: Variable) -> dict[str, str]:
    role = {"causality": row.causality, "variability": row.variability}
    calculated = row.causality in ("output", "local")
    return role | ({"initial": "calculated"} if calculated else {})


def _units(root: Any, table: Variables) -> None:
    group = ElementTree.SubElement(root, "UnitDefinitions")
    for unit in dict.fromkeys(row.unit for row in table.rows if row.unit != "1"):
        powers = {base: str(power) for base, power in coherent_unit(unit).exponents.items()}
        ElementTree.SubElement(ElementTree.SubElement(group, "Unit", name=unit), "BaseUnit", powers)


def _categories(root: Any) -> None:
    group = ElementTree.SubElement(root, "LogCategories")
    for name, told in (("logStatusError", "what is wrong"), ("logEvents", "why a simulation ends")):
        ElementTree.SubElement(group, "Category", name=name, description=told)


def _text(root: Any) -> str:
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"
