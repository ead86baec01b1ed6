// SPDX-License-Identifier: GPL-2.0-or-later
// Curves in YADE's 3D view, as cables and lines are drawn.
#pragma once

#include <lib/base/Math.hpp>

namespace yade {

struct Station { // of a curve
    Vector3r at, along;
    Vector3r color;
};

// From slack to the largest tension; as in the pictures of ancf.render.
Vector3r tensionColor(Real part);

// A line, which can be seen from afar.
void drawThread(const vector<Station>& curve);

// A tube, open at its ends.
void drawTube(const vector<Station>& curve, Real radius);

} // namespace yade
