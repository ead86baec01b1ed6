// SPDX-License-Identifier: GPL-2.0-or-later
#include "Tube.hpp"

#include "Gl.hpp"

#include <algorithm>
#include <cmath>

namespace yade {

namespace {
    constexpr int sides = 10;

    void vertex(const Gl& gl, const Vector3r& p) {
        gl.vertex(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    }

    void color(const Gl& gl, const Vector3r& c) {
        gl.color(static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]));
    }
} // namespace

Vector3r tensionColor(Real part) {
    static const Vector3r stops[] = {{.16, .32, .50}, {.17, .55, .75}, {.85, .60, .11}, {.84, .19, .12}};
    const Real x = 3 * std::min(1., std::max(0., part));
    const int k = std::min(2, static_cast<int>(x));
    return stops[k] + (x - k) * (stops[k + 1] - stops[k]);
}

void drawThread(const vector<Station>& curve) {
    const Gl& gl = Gl::calls();
    gl.disable(Gl::lighting);
    gl.lineWidth(2);
    gl.begin(Gl::lineStrip);
    for (const Station& s : curve) {
        color(gl, s.color);
        vertex(gl, s.at);
    }
    gl.end();
    gl.lineWidth(1);
    gl.enable(Gl::lighting);
}

void drawTube(const vector<Station>& curve, Real radius) {
    const Gl& gl = Gl::calls();
    // A direction across the curve, carried along it without twist.
    vector<Vector3r> across {curve[0].along.unitOrthogonal()};
    for (size_t i = 1; i < curve.size(); ++i)
        across.push_back((across[i - 1] - across[i - 1].dot(curve[i].along) * curve[i].along).normalized());
    for (size_t i = 0; i + 1 < curve.size(); ++i) {
        gl.begin(Gl::triangleStrip);
        for (int k = 0; k <= sides; ++k) {
            const Real angle = 2 * M_PI * k / sides;
            for (const size_t j : {i + 1, i}) {
                const Vector3r out = std::cos(angle) * across[j] + std::sin(angle) * curve[j].along.cross(across[j]);
                color(gl, curve[j].color);
                gl.normal(static_cast<float>(out[0]), static_cast<float>(out[1]), static_cast<float>(out[2]));
                vertex(gl, curve[j].at + radius * out);
            }
        }
        gl.end();
    }
}

} // namespace yade
