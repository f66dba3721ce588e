"""Echoes of a RADAR by range and speed, while a wing turns about its axis."""
import pathlib

import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
turned = lambda degrees: {"joint": {"wing_left/drive": f"{degrees}deg"}}
# 4 degrees within the dwell of 0.08 s
echoes = pw.radar(examples / "servicer/servicer.pxn", examples / "radar/docking_x_band.toml", camera=[13, -15.5, 8],
                  begin=turned(58), end=turned(62), **turned(60))
by_speed = echoes["mean_power_w"].sum(axis=1)
moving = by_speed[abs(echoes["speed_m_s"]) > 0.2].sum() / by_speed.sum()
print(f"cross-section {echoes['targets']['servicer']['cross_section_m2']:.3g} m2, {100 * moving:.2g} % of the echo moves")
