"""The reflectance of a material over angles."""
import numpy as np
import panwright as pw

print(len(pw.material_names()), "materials of the library")
angle = np.radians(np.arange(0, 90, 10))
to_viewer = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=1)
white = pw.material("white_z93")
for degrees, value in zip(np.degrees(angle), white.brdf([0, 0, 1], to_viewer)):
    print(f"{degrees:3.0f} degrees: {value.round(4)} 1/sr")
