"""Every parser of the project that reads what others wrote."""

from tests.fuzz.documents import DOCUMENTS
from tests.fuzz.streams import STREAMS

TARGETS = {target.name: target for target in (*STREAMS, *DOCUMENTS)}
