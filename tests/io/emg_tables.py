"""Tables of electromyograms as makers write them: two muscles, 1 s, a sine each."""

import numpy as np

RATE_HZ = 1000.0
TIMES_S = np.arange(1000) / RATE_HZ
TIBIALIS = 1e-4 * np.sin(2.0 * np.pi * 80.0 * TIMES_S)
VASTUS = 2e-4 * np.sin(2.0 * np.pi * 60.0 * TIMES_S)


def rows(*columns, mark=",", form="{:.9g}"):
    return "\n".join(mark.join(form.format(one) for one in row) for row in zip(*columns, strict=True)) + "\n"


def emgworks():
    """A line for each channel, then a column of times before each; an accelerometer ends earlier."""
    labels = "".join(
        f"Label: {name} Sampling frequency: {rate} Number of points: 1000 Unit: {unit} Domain: Time\n"
        for name, rate, unit in (
            ("TA R: EMG 1", 1000, "V"),
            ("TA R: ACC X", 148.148, "g"),
            ("VL L: EMG 2", 1000, "V"),
        )
    )
    text = labels + 'X[s],"TA R: EMG 1",X[s],"TA R: ACC X",X[s],"VL L: EMG 2"\n'
    for k, (t, a, b) in enumerate(zip(TIMES_S, TIBIALIS, VASTUS, strict=True)):
        slow = f"{k / 148.148:.6g},0.5" if k < 148 else ","
        text += f"{t:.6g},{a:.9g},{slow},{t:.6g},{b:.9g}\n"
    return text


def trigno_discover():
    """Sensors above their channels, rates below the titles, mV."""
    return (
        "Application:, Trigno Discover (1.7.0)\nDate/Time:, 4/12/2022\nCollection Length (seconds):, 1\n"
        "TIB ANT RT (54717), , VAST LAT LT (54718), \nmode: 1, , mode: 1, \n"
        "EMG 1 Time Series (s), EMG 1 (mV), EMG 1 Time Series (s), EMG 1 (mV)\n, 1000 Hz, , 1000 Hz\n"
    ) + rows(TIMES_S, 1e3 * TIBIALIS, TIMES_S, 1e3 * VASTUS, mark=", ")


def noraxon():
    """Four lines, tabs, microvolts."""
    return "Type\tRaw\nName\tx\nDate\t2022\n\nTime,s\tRT TIB.ANT.,uV\tLT VLO,uV\tMarker\n" + rows(
        TIMES_S, 1e6 * TIBIALIS, 1e6 * VASTUS, 0.0 * VASTUS, mark="\t"
    )


def bts():
    """Rate and unit above, a column of frames, decimal commas."""
    head = "BTS ASCII format\n\nType:\tEmg tracks\nMeasure unit:\tV\n\nTracks:\t2\nFrequency:\t1000 Hz\nFrames:\t1000\n"
    return (
        head
        + "Start time:\t0,000\n\nFrame\tTime\tR Tibialis Anterior\tL Vastus Lateralis\n"
        + rows(np.arange(1.0, 1001.0), TIMES_S, TIBIALIS, VASTUS, mark="\t").replace(".", ",")
    )


def storage():
    """OpenSim's, without a unit."""
    head = "EMG\nversion=1\nnRows=1000\nnColumns=3\ninDegrees=no\nendheader\n"
    return head + "time\tR_TibAnt\tL_VastLat\n" + rows(TIMES_S, TIBIALIS, VASTUS, mark="\t")


def plain():
    """A rate in a comment, no times, semicolons."""
    return "# sampling rate: 1000\n# offset: 0.25\nR TA (V);L VL (V)\n" + rows(TIBIALIS, VASTUS, mark=";")


FORMS = {
    "EMGworks": emgworks, "Trigno Discover": trigno_discover, "Noraxon": noraxon, "BTS": bts, "storage": storage,
    "plain": plain,
}  # fmt: skip
