"""A version of a stored map, as it is listed."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robotd.core.grid_spec import GridSpec
from robotd.maps.manifest import Manifest

UNSAVED = "unsaved"
"""Key of the metadata that marks a version nobody asked for."""


@dataclass(frozen=True, slots=True)
class MapEntry:
    """One version of a stored map."""

    name: str
    version: int
    digest: str
    """Of placement and cells: the map's identity. Empty if the manifest is damaged."""
    created_unix_ns: int
    metadata: dict[str, Any]
    path: Path
    """The directory; ``map.yaml`` in it is for other programs."""
    spec: GridSpec | None
    """Its placement; None if the manifest is damaged."""
    stops: int | None = None
    """How many stops it was made of; None if they are not stored with it."""
    damage: str | None = None
    """Why its manifest cannot be read."""

    @classmethod
    def of(cls, manifest: Manifest, path: Path) -> "MapEntry":
        """Return the version that a manifest describes."""
        return cls(
            name=manifest.name,
            version=manifest.version,
            digest=manifest.digest,
            created_unix_ns=manifest.created_unix_ns,
            metadata=manifest.metadata,
            path=path,
            spec=manifest.spec,
            stops=manifest.stops,
        )

    @classmethod
    def damaged(cls, name: str, version: int, path: Path, why: str) -> "MapEntry":
        """Return a version whose manifest cannot be read."""
        return cls(name, version, "", 0, {}, path, None, damage=why)

    @property
    def is_unsaved(self) -> bool:
        """Whether nobody asked for it: it was kept so that it is not lost."""
        return self.metadata.get(UNSAVED) is True
