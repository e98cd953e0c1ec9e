"""The report: one HTML file without outside parts, and each of its tables as CSV and JSON."""
import base64
import csv
import datetime
import html
import json
import math
import pathlib
import platform
import re

STYLE = """
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.35rem; margin-top: 3rem; } h3 { font-size: 1.05rem; margin-top: 2rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 1rem 0; font-size: .9rem; }
th, td { padding: .2rem .6rem; text-align: left; border-bottom: 1px solid #8884; vertical-align: top; }
td.paper { font-style: italic; } td.number { text-align: right; white-space: nowrap; }
figure { margin: 1rem 0; overflow-x: auto; } figure svg, figure img { background: #fff; max-width: 100%; height: auto; }
figcaption, .small { color: #777; font-size: .85rem; } .missing { border-left: 4px solid #d55e00; padding-left: .8rem; }
pre { overflow-x: auto; font-size: .8rem; } nav a { margin-right: 1rem; }
"""


def with_interval(value: float | None, interval: tuple[float, float] | list[float] | None = None, decimals: int = 3) -> str:
    if value is None or not math.isfinite(value):
        return "–"
    text = f"{value:.{decimals}f}"
    return text if interval is None else f"{text} [{interval[0]:.{decimals}f}, {interval[1]:.{decimals}f}]"


def wilson(rate: float, total: int) -> tuple[float, float]:
    """95 % score interval of a share of `total`."""
    if total == 0:
        return (0.0, 1.0)
    z = 1.959963984540054
    centre = (rate + z * z / (2 * total)) / (1 + z * z / total)
    half = z / (1 + z * z / total) * math.sqrt(rate * (1 - rate) / total + z * z / (4 * total * total))
    return (max(0.0, centre - half), min(1.0, centre + half))


class Report:
    def __init__(self, out: pathlib.Path, title: str):
        self.out = out
        self.title = title
        self.body: list[str] = []
        self.contents: list[tuple[str, str]] = []
        (out / "tables").mkdir(parents=True, exist_ok=True)

    def heading(self, text: str) -> None:
        anchor = f"s{len(self.contents)}"
        self.contents.append((anchor, text))
        self.body.append(f'<h2 id="{anchor}">{html.escape(text)}</h2>')

    def subheading(self, text: str) -> None:
        self.body.append(f"<h3>{html.escape(text)}</h3>")

    def paragraph(self, text: str) -> None:
        self.body.append(f"<p>{html.escape(text)}</p>")

    def missing(self, text: str) -> None:
        """What the papers have and this run has not."""
        self.body.append(f'<p class="missing">{html.escape(text)}</p>')

    def svg(self, file: pathlib.Path, caption: str) -> None:
        text = file.read_text()
        text = text[text.index("<svg"):]
        # Ids must not meet those of other figures on the page.
        prefix = f"f{len(self.body)}-"
        text = re.sub(r'(\bid="|url\(#|href="#)', lambda found: found.group(1) + prefix, text)
        self.body.append(f"<figure>\n{text}\n<figcaption>{html.escape(caption)}</figcaption>\n</figure>")

    def png(self, file: pathlib.Path, caption: str) -> None:
        data = base64.b64encode(file.read_bytes()).decode()
        self.body.append(f'<figure><img alt="{html.escape(caption)}" src="data:image/png;base64,{data}">'
                         f"<figcaption>{html.escape(caption)}</figcaption></figure>")

    def table(self, name: str, header: list[str], rows: list[list[object]], paper_columns: tuple[int, ...] = ()) -> None:
        """On the page, and as tables/NAME.csv and .json. `paper_columns` hold the papers' own numbers."""
        with (self.out / "tables" / f"{name}.csv").open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([header, *rows])
        records = [dict(zip(header, row)) for row in rows]
        (self.out / "tables" / f"{name}.json").write_text(json.dumps(records, indent=1, ensure_ascii=False) + "\n")
        lines = ["<tr>" + "".join(f"<th>{html.escape(cell)}</th>" for cell in header) + "</tr>"]
        for row in rows:
            cells = []
            for i, cell in enumerate(row):
                text = with_interval(cell) if isinstance(cell, float) else str(cell)
                kind = "paper" if i in paper_columns else "number" if re.match(r"^[–+\-−]?[\d.]*( \[|$)", text) else ""
                cells.append(f'<td class="{kind}">{html.escape(text)}</td>')
            lines.append("<tr>" + "".join(cells) + "</tr>")
        self.body.append('<div class="scroll"><table>' + "\n".join(lines) + f'</table></div><p class="small">tables/{name}.csv, .json</p>')

    def provenance(self, program, size, logs) -> None:
        cpu = platform.processor() or "unknown"
        info = pathlib.Path("/proc/cpuinfo")
        if info.exists():
            cpu = next((line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")), cpu)
        self.paragraph(f"{program.version()}; size of the run: {size.name}; seed {program.seed}; {cpu}; "
                       f"{datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d %H:%M} UTC.")
        self.paragraph("P1 is “FLIRT – Interest Regions for 2D Range Data with Applications to Robot Navigation”, P2 “FLIRT – Interest "
                       "Regions for 2D Range Data” (ICRA 2010). The papers' own numbers are in italics. Intervals are 95 %: of shares "
                       "Wilson's, of means a bootstrap over reference locations or over blocks of 10 m of trajectory.")
        if logs.simulated:
            self.missing("No real logs were given: everything below ran on simulated buildings. The papers' numbers stand beside for "
                         "orientation only; they belong to other data.")
        rows = [[log.name, log.scans, log.beams, log.stands_for] for log in logs.corrected + logs.tuning + logs.stand_ins]
        self.table("logs", ["data set", "scans", "beams", "stands for"], [row for i, row in enumerate(rows) if row not in rows[:i]])

    def commands(self, program, seconds: float) -> None:
        self.heading("How to repeat it")
        self.paragraph(f"The whole run took {seconds:.0f} s. Commands, with their wall-clock seconds:")
        lines = "\n".join(f"{took:7.1f}  {command}" for command, took in program.history)
        self.body.append(f"<pre>{html.escape(lines)}</pre>")

    def write(self) -> None:
        links = "".join(f'<a href="#{anchor}">{html.escape(text)}</a>' for anchor, text in self.contents)
        page = (f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
                f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{html.escape(self.title)}</title>\n'
                f"<style>{STYLE}</style>\n</head>\n<body>\n<h1>{html.escape(self.title)}</h1>\n<nav>{links}</nav>\n"
                + "\n".join(self.body) + "\n</body>\n</html>\n")
        temporary = self.out / "report.html.tmp"
        temporary.write_text(page)
        temporary.replace(self.out / "report.html")
