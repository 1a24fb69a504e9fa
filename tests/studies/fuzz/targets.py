"""Every parser of the project that reads what others wrote, and the replay of what it read."""

from tests.studies.fuzz.browsers import BROWSERS
from tests.studies.fuzz.documents import DOCUMENTS
from tests.studies.fuzz.formats import FORMATS
from tests.studies.fuzz.replays import REPLAYS
from tests.studies.fuzz.streams import STREAMS

TARGETS = {target.name: target for target in (*STREAMS, *DOCUMENTS, *FORMATS, *BROWSERS, *REPLAYS)}
