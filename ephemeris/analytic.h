// The Sun, the Moon and the rotations of the Earth and the Moon by their date alone.
//
// Sources: Standish, Keplerian elements for approximate positions of the major planets (JPL, 1800
// to 2050); Meeus, Astronomical Algorithms, 47 (terms of ELP-2000/82 of Chapront-Touzé and
// Chapront); Capitaine, Wallace and Chapront 2003 and 2005 (precession IAU 2006, sidereal time);
// the ten largest terms of the nutation IAU 2000B; Archinal and others 2011 (the Moon's rotation).
// Errors, measured against DE430, DE441 and DE405 at dates of 1969 to 2015, and stated for 1900 to
// 2100 where others measured them: see each function.
#pragma once

#include "ephemeris/state.h"

namespace panwright::ephemeris {

// Return positions from the Earth's centre, km in axes of J2000, without light time or aberration.
//
//   et  seconds of TDB past J2000; within 1800 to 2050
// Sun: within 30″ and 2e-4 of the distance. Moon: within 20″ and 35 km.
Vec3 sun_from_earth(double et);
Vec3 moon_from_earth(double et);

// Returns the attitude of axes fixed to the Earth: z to the celestial pole, x to the meridian of
// Greenwich.
//
//   ut1  seconds of UT1 past 2000-01-01T12:00:00; UTC in its place turns by up to 13.5″
// Without polar motion (0.6″ at most) and small terms of the nutation (0.1″).
Attitude earth_attitude(double et, double ut1);

// Returns the attitude of the Moon's mean Earth and polar axes: within 0.005°.
Attitude moon_attitude(double et);

}  // namespace panwright::ephemeris
