"""A sheet of crinkled foil as heights."""
import panwright as pw

sheet = pw.sheet("crinkled", width=0.3, height=0.2, seed=7)
print(sheet.heights.shape, "vertices", sheet.spacing, "m apart")
print("rms height", sheet.height_rms, "m, rms slope", sheet.slope_rms)
print("highest", sheet.heights.max(), "m")
