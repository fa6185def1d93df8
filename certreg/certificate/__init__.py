"""Certificates: what is proved about a pose, in a file that anyone can check."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.certificate.bounds import ExactPose as ExactPose
    from certreg.certificate.bounds import PoseBounds as PoseBounds
    from certreg.certificate.bounds import angle_from as angle_from
    from certreg.certificate.bounds import flat_energy as flat_energy
    from certreg.certificate.bounds import pose_bounds as pose_bounds
    from certreg.certificate.bounds import pose_energy as pose_energy
    from certreg.certificate.bounds import sin2_half_angle_between as sin2_half_angle_between
    from certreg.certificate.checking import CertificateVerdict as CertificateVerdict
    from certreg.certificate.checking import bounded_clouds as bounded_clouds
    from certreg.certificate.checking import check_own as check_own
    from certreg.certificate.checking import check_own_consensus as check_own_consensus
    from certreg.certificate.checking import require_accepted as require_accepted
    from certreg.certificate.checking import verify as verify
    from certreg.certificate.checking import verify_lines as verify_lines
    from certreg.certificate.checking import verify_with_coq as verify_with_coq
    from certreg.certificate.consensus import ConsensusBody as ConsensusBody
    from certreg.certificate.consensus import ConsensusSimilarityBody as ConsensusSimilarityBody
    from certreg.certificate.consensus import ScaleRange as ScaleRange
    from certreg.certificate.consistency import consistent_pairs as consistent_pairs
    from certreg.certificate.count import AT_MOST as AT_MOST
    from certreg.certificate.count import CountBody as CountBody
    from certreg.certificate.envelope import Certificate as Certificate
    from certreg.certificate.envelope import body_of as body_of
    from certreg.certificate.isotropic import Claims as Claims
    from certreg.certificate.isotropic import IsotropicBody as IsotropicBody
    from certreg.certificate.isotropic import RotationState as RotationState
    from certreg.certificate.isotropic import SimilarityBody as SimilarityBody
    from certreg.certificate.isotropic import SimilarityClaims as SimilarityClaims
    from certreg.certificate.listing import ListProposal as ListProposal
    from certreg.certificate.listing import list_body as list_body
    from certreg.certificate.many import Certificates as Certificates
    from certreg.certificate.many import certificates_of as certificates_of
    from certreg.certificate.private_folder import sweep as sweep
    from certreg.certificate.producing import count_certificate as count_certificate
    from certreg.certificate.producing import produce as produce
    from certreg.certificate.producing import produce_similarity as produce_similarity
    from certreg.certificate.producing_consensus import ConsensusProver as ConsensusProver
    from certreg.certificate.producing_consensus import ProvedConsensus as ProvedConsensus
    from certreg.certificate.producing_consensus import (
        consensus_certificate as consensus_certificate,
    )
    from certreg.certificate.producing_consensus import consensus_of as consensus_of
    from certreg.certificate.producing_consensus import pose_of as pose_of
    from certreg.certificate.producing_springs import springs_certificate as springs_certificate
    from certreg.certificate.producing_springs import (
        springs_list_certificate as springs_list_certificate,
    )
    from certreg.certificate.radius import MOST_DEGREES as MOST_DEGREES
    from certreg.certificate.radius import Radius as Radius
    from certreg.certificate.shared_motion import CommonMotion as CommonMotion
    from certreg.certificate.shared_motion import common_motion as common_motion
    from certreg.certificate.shared_motion import sets_apart as sets_apart
    from certreg.certificate.spring_bounds import spring_pose_bounds as spring_pose_bounds
    from certreg.certificate.springs_basin import Barrier as Barrier
    from certreg.certificate.springs_basin import SpringState as SpringState
    from certreg.certificate.springs_basin import barrier_of as barrier_of
    from certreg.certificate.springs_basin import basin_of_springs as basin_of_springs
    from certreg.certificate.springs_cones import SpringsConesBody as SpringsConesBody
    from certreg.certificate.springs_list import ListClaims as ListClaims
    from certreg.certificate.springs_list import SpringsListBody as SpringsListBody
    from certreg.certificate.springs_sos import SpringsClaims as SpringsClaims
    from certreg.certificate.springs_sos import SpringsSosBody as SpringsSosBody
    from certreg.certificate.truncated import TruncatedClaims as TruncatedClaims
    from certreg.certificate.truncated import TruncatedRotationBody as TruncatedRotationBody
    from certreg.certificate.truncated import disproves_labels as disproves_labels
    from certreg.certificate.truncated import (
        truncated_certificate as truncated_certificate,
    )

__getattr__ = lazy_face(
    __name__,
    {
        "bounds": (
            "ExactPose",
            "PoseBounds",
            "angle_from",
            "flat_energy",
            "pose_bounds",
            "pose_energy",
            "sin2_half_angle_between",
        ),
        "checking": (
            "CertificateVerdict",
            "bounded_clouds",
            "check_own",
            "check_own_consensus",
            "require_accepted",
            "verify",
            "verify_lines",
            "verify_with_coq",
        ),
        "consensus": ("ConsensusBody", "ConsensusSimilarityBody", "ScaleRange"),
        "consistency": ("consistent_pairs",),
        "count": (
            "AT_MOST",
            "CountBody",
        ),
        "envelope": ("Certificate", "body_of"),
        "isotropic": (
            "Claims",
            "IsotropicBody",
            "RotationState",
            "SimilarityBody",
            "SimilarityClaims",
        ),
        "listing": (
            "ListProposal",
            "list_body",
        ),
        "many": (
            "Certificates",
            "certificates_of",
        ),
        "private_folder": ("sweep",),
        "producing": (
            "count_certificate",
            "produce",
            "produce_similarity",
        ),
        "producing_consensus": (
            "ProvedConsensus",
            "ConsensusProver",
            "consensus_certificate",
            "consensus_of",
            "pose_of",
        ),
        "producing_springs": (
            "springs_certificate",
            "springs_list_certificate",
        ),
        "radius": (
            "MOST_DEGREES",
            "Radius",
        ),
        "shared_motion": ("CommonMotion", "common_motion", "sets_apart"),
        "springs_cones": ("SpringsConesBody",),
        "springs_basin": (
            "Barrier",
            "SpringState",
            "barrier_of",
            "basin_of_springs",
        ),
        "springs_list": (
            "ListClaims",
            "SpringsListBody",
        ),
        "springs_sos": (
            "SpringsClaims",
            "SpringsSosBody",
        ),
        "spring_bounds": ("spring_pose_bounds",),
        "truncated": (
            "TruncatedClaims",
            "TruncatedRotationBody",
            "disproves_labels",
            "truncated_certificate",
        ),
    },
)
