"""A process that follows disturbed streams of one protocol, one after the other, and reports the fate of each.

python -m benchmarks.streams.child FOLDER PROTOCOL FAULT:SEED …
"""

import sys

from benchmarks.robustness.stream_child import main
from benchmarks.streams.faults import FAULTS
from benchmarks.streams.wires import WIRES

if __name__ == "__main__":
    main(sys.argv[1:], FAULTS[sys.argv[2]], WIRES[sys.argv[2]])
