"""Plots of runs, each in one call. matplotlib is imported when the first is made; each returns its figure."""
import numpy as _np


def _figure(rows, title):
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(rows, 1, sharex=True, figsize=(8.0, 2.2 * rows + 0.6), squeeze=False)
    figure.suptitle(title)
    return figure, axes[:, 0]


def wrenches(F_D, dt_s, title="wrench on the hand"):
    """Force and torque over time: F_D (n, 6) [N, N m], a row each dt_s [s]."""
    F_D = _np.asarray(F_D, dtype=float)
    time = _np.arange(len(F_D)) * dt_s
    figure, (force, torque) = _figure(2, title)
    for axis, label in enumerate("xyz"):
        force.plot(time, F_D[:, axis], label=label)
        torque.plot(time, F_D[:, 3 + axis], label=label)
    force.set_ylabel("force [N]")
    torque.set_ylabel("torque [N m]")
    torque.set_xlabel("time [s]")
    force.legend(loc="upper right")
    return figure


def columns(names, table, dt_s, shown=("sent_fx_N", "sent_fy_N", "sent_fz_N"), title="trace"):
    """Columns of a trace or a recording over time, one panel each."""
    figure, panels = _figure(len(shown), title)
    time = _np.arange(len(table)) * dt_s
    for panel, name in zip(panels, shown):
        panel.plot(time, table[:, list(names).index(name)])
        panel.set_ylabel(name)
    panels[-1].set_xlabel("time [s]")
    return figure


def recording(read, shown=("sent_fx_N", "sent_fy_N", "sent_fz_N")):
    """Columns of a tactum.Recording over time."""
    return columns(read.columns, read.table, read.dt_s, shown, title=f"{read.scene} on {read.device}")
