"""Equations for the page of the derivation, from the files that derive them; drawings on the site."""

import io
import re
from html import escape

import matplotlib
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import math_to_image
from sympy import cos, latex, sin

import desaxe as dx
from desaxe.compiler.text import with_short_temporaries, write_lines
from desaxe.derive import loop, stable
from desaxe.derive.dynamics import define_dynamics
from desaxe.derive.equation import LATEX_NAMES, latex_name
from desaxe.derive.sheet import Sheet
from desaxe.mechanism.program import Variant, program_of

# What symbols that are no quantities are called.
NAMES = {
    "margin_out": "q", "eps": r"\varepsilon", "side": r"\varsigma", "abs_sin": r"|\sin\theta|",
    "less": r"(\overline{BC} - |u|)", "crank_ratio": "k", "tan_phi": r"\tan\varphi",
    "phi_wrt_theta": r"\varphi'",
    "Y_wrt_theta": "Y'", "inv_S": "S^{-1}", "offset_ratio": r"\frac{e_c}{S}",
    "margin_ratio": r"\frac{m n}{S^2}", "AB_out": r"\varsigma\nu\overline{AB}", "m_at_B": "m_B",
    "m_at_C": "m_C",
    "m_reciprocating": r"m_{rec}", "m_total": "m_{all}", "omega2": r"\omega^2", "crank_X": r"\ddot e_X",
    "crank_Y": r"\ddot e_Y", "side_push": r"P_X", "thrust": "P_Y", "swing": "H", "I_turning": "I_A",
    "I_lumping": r"I_{lump}", "thrust_smooth": r"P_{Y,0}", "N_smooth": r"N_{C,0}", "lean": r"\lambda",
    "rod_twist": "Q", "M_eff": r"M_{eff}", "T_in": r"T_{in}", "kinetic_energy": r"E_{kin}",
    "potential_energy": r"E_{pot}",
}  # fmt: skip


def equation(*names):
    """Quantities as `desaxe.equation` derives them."""
    rows = [dx.equation(name) for name in names]
    return "\n\n".join(f"{_math(row.latex)}\n\n`{row.name}`: {_about(row)}." for row in rows)


def _about(row):
    source = f", paper {row.source}" if row.source else ""
    return f"{row.meaning}{f' [{row.unit}]' if row.unit != '1' else ''}{source}"


def closure():
    """The vector loop along X and along Y, from the file that the derivation starts from."""
    sides = zip(loop.CRANK + loop.ROD, loop.SLIDER, strict=True)
    return "\n\n".join(_math(" = ".join(map(_latex, pair))) for pair in sides)


def dynamics(*names):
    """Equations of the forces, which the derivation holds against the three free bodies."""
    sheet = Sheet(())
    define_dynamics(sheet)
    rows = [(name, sheet.equations[name]) for name in names]
    return "\n\n".join(f"{_named(name, row.expression)}\n\n`{name}`: {row.meaning}." for name, row in rows)


def wide_forms():
    """What replaces BC - |u| and BC^2 - u^2, and is proved to be the same."""
    (near, by), _ = stable.LESS
    small = stable.cos_theta**2 / (1 + stable.abs_sin)
    reach = near - by.subs(stable.crank_drop, -stable.AB_out * stable.eps)
    rows = {
        r"\varepsilon = 1 - |\sin\theta|": small,
        r"\overline{BC} - |u|": reach,
        r"S^2 = \overline{BC}^2 - u^2": stable.HEIGHT_AREA,
    }
    return "\n\n".join(_math(f"{head} = {_latex(expression)}") for head, expression in rows.items())


def wide_margins():
    """The test for a design with wide margins."""
    return _math(rf"\overline{{AB}} + |e_c| < {stable.WIDE_MARGIN_SHARE:.3f}\, \overline{{BC}}")


def both_forms():
    """The stable and the plain form of one derivative, each proved against the chain rule."""
    _, plain, careful = stable.phi_rate(2).args
    return "\n\n".join(_math(rf"\varphi'' = {_latex(form)}") for form in (careful, plain))


def steps(name, form=""):
    """The lines that are computed for a quantity: stable, or for a design with wide margins (`plain`)."""
    program = program_of((name,), Variant(wide_margins=form == "plain"))
    return "```text\n" + "\n".join(write_lines(with_short_temporaries(program))) + "\n```"


def _named(name, expression):
    return _math(f"{NAMES.get(name) or latex_name(name)} = {_latex(expression)}")


def _latex(expression):
    trigonometry = {stable.sin_theta: sin(loop.theta), stable.cos_theta: cos(loop.theta)}
    shown = expression.subs(trigonometry)
    names = {
        s: NAMES.get(s.name) or LATEX_NAMES.get(s.name) or latex_name(s.name) for s in shown.free_symbols
    }
    return latex(shown, symbol_names=names)


def _math(text):
    """LaTeX as a block of a page."""
    return f"```math\n{text}\n```"


def drawing_of(text):
    """LaTeX as a drawing, which needs neither a script nor a font, and its source to copy."""
    file = io.BytesIO()
    with matplotlib.rc_context({"mathtext.fontset": "cm", "svg.fonttype": "path"}):
        math_to_image(f"${_spaced(text)}$", file, prop=FontProperties(size=16), format="svg")
    drawing = file.getvalue().decode().partition("-//W3C//DTD")[2].partition(">")[2]
    drawing = re.sub(
        r"<metadata>.*?</metadata>|<!--.*?-->|<g id=\"patch_1\">.*?</g>", "", drawing, flags=re.S
    )
    drawing = re.sub(r"\s*\n\s*", " ", drawing).replace("<svg", '<svg role="img" fill="currentColor"', 1)
    source = f"<details><summary>LaTeX</summary><pre><code>{escape(text)}</code></pre></details>"
    return f'<div class="equation" aria-label="{escape(text)}">{drawing}</div>{source}'


def _spaced(text):
    """The same as it is best drawn: plain parentheses about a letter, room in front of a function."""
    text = re.sub(r"\\left\((\\?\w+) *\\right\)", r"(\1)", text)
    return re.sub(r"(?<=\S) (\\(?:sin|cos)\b)", r" \\,\1", text)


WRITERS = (equation, closure, dynamics, wide_forms, wide_margins, both_forms, steps)
