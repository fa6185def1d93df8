"""Results for readers: JSON documents for programs, plain sentences for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.report.breaking import BreakingCourse as BreakingCourse
    from certreg.report.breaking import breaking_course as breaking_course
    from certreg.report.breaking import breaking_fragment as breaking_fragment
    from certreg.report.breathing import scaled_enumeration_summary as scaled_enumeration_summary
    from certreg.report.document import ERROR_SCHEMA as ERROR_SCHEMA
    from certreg.report.document import dumps as dumps
    from certreg.report.document import equilibria_document as equilibria_document
    from certreg.report.document import error_document as error_document
    from certreg.report.document import result_document as result_document
    from certreg.report.document import scaled_document as scaled_document
    from certreg.report.equilibria import equilibria_words as equilibria_words
    from certreg.report.file_names import FILES as FILES
    from certreg.report.file_names import REPORT as REPORT
    from certreg.report.folder import write_folder as write_folder
    from certreg.report.judged_pose import assessment_document as assessment_document
    from certreg.report.judged_pose import assessment_summary as assessment_summary
    from certreg.report.markup import printable as printable
    from certreg.report.markup import rendered as rendered
    from certreg.report.methods import enumeration_summary as enumeration_summary
    from certreg.report.pages import html_page as html_page
    from certreg.report.pair_fields import pairs_document as pairs_document
    from certreg.report.presenting import PRESENTER as PRESENTER
    from certreg.report.reload import certified_pose as certified_pose
    from certreg.report.reload import report_of as report_of
    from certreg.report.spring_equilibria import (
        spring_enumeration_summary as spring_enumeration_summary,
    )
    from certreg.report.spring_equilibria import (
        spring_equilibria_document as spring_equilibria_document,
    )
    from certreg.report.summary import registration_summary as registration_summary
    from certreg.report.summary import simulation_summary as simulation_summary

__getattr__ = lazy_face(
    __name__,
    {
        "breaking": (
            "BreakingCourse",
            "breaking_course",
            "breaking_fragment",
        ),
        "breathing": ("scaled_enumeration_summary",),
        "judged_pose": ("assessment_document", "assessment_summary"),
        "document": (
            "ERROR_SCHEMA",
            "dumps",
            "equilibria_document",
            "error_document",
            "result_document",
            "scaled_document",
        ),
        "file_names": ("FILES", "REPORT"),
        "folder": ("write_folder",),
        "equilibria": ("equilibria_words",),
        "markup": (
            "printable",
            "rendered",
        ),
        "methods": ("enumeration_summary",),
        "pages": ("html_page",),
        "pair_fields": ("pairs_document",),
        "presenting": ("PRESENTER",),
        "reload": ("certified_pose", "report_of"),
        "spring_equilibria": (
            "spring_enumeration_summary",
            "spring_equilibria_document",
        ),
        "summary": (
            "registration_summary",
            "simulation_summary",
        ),
    },
)
