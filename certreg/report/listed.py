"""Words and documents of results that hold what is shown: lists of equilibria."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import late
from certreg.report.document import equilibria_document
from certreg.report.methods import enumeration_summary

if TYPE_CHECKING:
    from certreg.registration.enumeration import ListedEquilibria
    from certreg.registration.spring_equilibria import ListedSpringEquilibria
    from certreg.report import spring_equilibria
    from certreg.report.encoding import Document
else:
    spring_equilibria = late("certreg.report.spring_equilibria")


def enumeration_words(listed: ListedEquilibria) -> str:
    """The text of a list of equilibria."""
    return enumeration_summary(listed.enumeration)


def enumeration_document(listed: ListedEquilibria) -> Document:
    """Its document."""
    return equilibria_document(listed.enumeration)


def spring_enumeration_words(listed: ListedSpringEquilibria) -> str:
    """The text of a list of equilibria on general springs."""
    return spring_equilibria.spring_enumeration_summary(listed.enumeration)


def spring_enumeration_document(listed: ListedSpringEquilibria) -> Document:
    """Its document."""
    return spring_equilibria.spring_equilibria_document(listed.enumeration)
