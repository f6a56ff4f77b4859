"""The report as one page, which needs nothing else: no script, no font, no link outwards."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.report.contents import Report, state_of


def page(report: Report) -> str:
    """Return the page as HTML."""
    environment = Environment(
        loader=PackageLoader("eddi_scaffold", "report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    picture = drawn(report.diagram)
    states = {package: state_of(of) for package, of in report.verified.items()}
    return environment.get_template("page.html.jinja").render(
        report=report,
        states=states,
        picture=Markup(picture),  # noqa: S704 - its texts are escaped where it is drawn
    )
