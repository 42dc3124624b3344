"""Every notebook of python/examples, and every example of the manual in Python, executes."""
import ast
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from support import BIN, ROOT, experiment, main, virtual_run

EXAMPLES = ROOT / "python" / "examples"


class Notebooks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="lab_python_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        virtual_run(cls.folder / "runs", "abp", "--set", "duration_s=300", "--set", "robots[0].count=4")
        cls.environment = {**os.environ, "MPLBACKEND": "agg", "LAB": str(BIN / "lab"),
                           "LAB_EXPERIMENT": str(experiment("speed_by_light")), "LAB_SCAN": str(experiment("vicsek"))}

    def execute(self, name):
        """The cells one after the other, in one namespace; with nbconvert, if it is installed."""
        notebook = EXAMPLES / name
        cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        for cell in cells:
            self.assertNotIn("outputs" if cell.get("outputs") else "nothing", cell, f"{name} has stored outputs")
        script = self.folder / (notebook.stem + ".py")
        script.write_text("\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"))
        self.run_in_folder([sys.executable, "-B", script], name)
        if subprocess.run([sys.executable, "-c", "import nbconvert, ipykernel"], capture_output=True).returncode == 0:
            self.run_in_folder([sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--output-dir",
                                self.folder / "executed", notebook], name)

    def run_in_folder(self, command, name):
        done = subprocess.run(list(map(str, command)), cwd=self.folder, env=self.environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, f"{name}: {done.stdout[-2000:]}{done.stderr[-3000:]}")
        return done.stdout

    def test_from_run_to_figure(self):
        self.execute("from_run_to_figure.ipynb")
        for figure in ("tracks.png", "msd.png"):
            self.assertGreater((self.folder / figure).stat().st_size, 5000)

    def test_own_estimator(self):
        self.execute("own_estimator.ipynb")

    def test_own_closed_loop(self):
        self.execute("own_closed_loop.ipynb")
        self.assertGreater((self.folder / "closed_loop.png").stat().st_size, 5000)

    def test_field_tools(self):
        self.execute("field_tools.ipynb")

    def test_campaign_to_phase_diagram(self):
        self.execute("campaign_to_phase_diagram.ipynb")
        self.assertGreater((self.folder / "phase_diagram.png").stat().st_size, 5000)
        points = (self.folder / "vicsek_scan" / "points.csv").read_text().splitlines()
        self.assertEqual(len(points), 1 + 9)

    def test_every_notebook_has_a_test(self):
        self.assertEqual({notebook.stem for notebook in EXAMPLES.glob("*.ipynb")},
                         {"from_run_to_figure", "own_estimator", "own_closed_loop", "campaign_to_phase_diagram",
                          "field_tools"})
        for notebook in EXAMPLES.glob("*.ipynb"):
            self.assertTrue(hasattr(self, "test_" + notebook.stem), notebook.name)

    def test_the_manual_has_the_closed_loop_of_the_examples(self):
        loop = (EXAMPLES / "along_x.py").read_text().split("\n", 1)[1]
        self.assertIn("\n".join(line for line in loop.splitlines() if line.strip()),
                      "\n".join(line.split("  #")[0].rstrip() for line in
                                (ROOT / "docs" / "python.md").read_text().splitlines() if line.strip()))

    def test_python_in_the_manual_compiles_and_names_what_exists(self):
        import active_lab

        blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "python.md").read_text(), re.S)
        self.assertGreater(len(blocks), 3)
        owners = {"run": active_lab.Run, "lab": active_lab.Lab, "log": active_lab.Log, "field": active_lab.Field,
                  "active_lab": active_lab}
        known = {"run": active_lab.open(next((self.folder / "runs").glob("*")))}
        for block in blocks:
            for node in ast.walk(ast.parse(block)):
                if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in owners:
                    owner = known.get(node.value.id, owners[node.value.id])
                    self.assertTrue(hasattr(owner, node.attr), f"{node.value.id}.{node.attr}")


if __name__ == "__main__":
    main()
