"""The bases of global modes: one file each, one registry, one orthonormalisation (`build`)."""

from warpffrf.offline.bases.build import BASES, GlobalBasis, build_basis

__all__ = ["BASES", "GlobalBasis", "build_basis"]
