"""The type hints of the package hold (mypy)."""
import subprocess
import sys
from pathlib import Path

import active_lab
from support import SKIPPED

if subprocess.run([sys.executable, "-m", "mypy", "--version"], capture_output=True).returncode != 0:
    print("skipped: mypy is not installed")
    sys.exit(SKIPPED)
# The build has links to the sources and the stubs that it made.
package = Path(active_lab.__file__).parent
sys.exit(subprocess.run([sys.executable, "-m", "mypy", "--ignore-missing-imports", "--disallow-untyped-defs",
                         "--no-error-summary", "--cache-dir", "/dev/null", "-p", "active_lab"],
                        cwd=package.parent).returncode)
