// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableDrawing.hpp"

#include "CableEngine.hpp"
#include "Gl.hpp"

#include <chrono>
#include <map>

namespace yade {

YADE_PLUGIN((Gl1_CableElement))

Real Gl1_CableElement::fullTension = 0;
int Gl1_CableElement::parts = 8;

namespace {
    constexpr int sides = 10;

    struct Station { // of a curve, in the body's frame
        Vector3r at, along;
        Vector3r color;
    };

    // From slack to the largest tension; as in the pictures of ancf.render.
    Vector3r colorOf(Real part) {
        static const Vector3r stops[] = {{.16, .32, .50}, {.17, .55, .75}, {.85, .60, .11}, {.84, .19, .12}};
        const Real x = 3 * std::min(1., std::max(0., part));
        const int k = std::min(2, static_cast<int>(x));
        return stops[k] + (x - k) * (stops[k + 1] - stops[k]);
    }

    // Over the elements of an engine, looked at from time to time [N].
    Real largestTension(CableEngine& cables) {
        using Clock = std::chrono::steady_clock;
        struct Seen {
            Clock::time_point when;
            Real most;
        };
        static std::map<int, Seen> all;
        const auto now = Clock::now();
        const auto known = all.find(cables.family);
        if (known != all.end() && now - known->second.when < std::chrono::milliseconds(200)) return known->second.most;
        Real most = 0;
        for (int e = 0; e < cables.nElements(); ++e) most = std::max(most, cables.tension(e, .5));
        all[cables.family] = {now, most};
        return most;
    }

    vector<Station> curveOf(CableEngine& cables, int element, const State& frame, int parts) {
        const Real full = Gl1_CableElement::fullTension > 0 ? Gl1_CableElement::fullTension : largestTension(cables);
        const Quaternionr back = frame.ori.conjugate();
        vector<Station> curve;
        for (int i = 0; i <= parts; ++i) {
            constexpr Real h = 1e-3;
            const Real xi = Real(i) / parts;
            const Vector3r ahead = cables.point(element, std::min(1., xi + h));
            const Vector3r behind = cables.point(element, std::max(0., xi - h));
            const Real tension = cables.tension(element, xi);
            curve.push_back({back * (cables.point(element, xi) - frame.pos), (back * (ahead - behind)).normalized(),
                             colorOf(full > 0 ? tension / full : 0)});
        }
        return curve;
    }

    void vertex(const Gl& gl, const Vector3r& p) {
        gl.vertex(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    }

    void color(const Gl& gl, const Vector3r& c) {
        gl.color(static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]));
    }

    void drawLine(const Gl& gl, const vector<Station>& curve) {
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

    void drawTube(const Gl& gl, const vector<Station>& curve, Real radius) {
        // A direction across the curve, carried along it without twist.
        vector<Vector3r> across {curve[0].along.unitOrthogonal()};
        for (size_t i = 1; i < curve.size(); ++i)
            across.push_back((across[i - 1] - across[i - 1].dot(curve[i].along) * curve[i].along).normalized());
        for (size_t i = 0; i + 1 < curve.size(); ++i) {
            gl.begin(Gl::triangleStrip);
            for (int k = 0; k <= sides; ++k) {
                const Real angle = 2 * M_PI * k / sides;
                for (const size_t j : {i + 1, i}) {
                    const Vector3r out =
                        std::cos(angle) * across[j] + std::sin(angle) * curve[j].along.cross(across[j]);
                    color(gl, curve[j].color);
                    gl.normal(static_cast<float>(out[0]), static_cast<float>(out[1]), static_cast<float>(out[2]));
                    vertex(gl, curve[j].at + radius * out);
                }
            }
            gl.end();
        }
    }
} // namespace

void Gl1_CableElement::go(const shared_ptr<Shape>& shape, const shared_ptr<State>& state, bool wire,
                          const GLViewInfo&) {
    const auto& element = static_cast<const CableElement&>(*shape);
    vector<Station> curve;
    {
        const PatientGuard guard;
        CableEngine* cables = guard ? CableEngine::of(*scene, element.family) : nullptr;
        if (!cables || element.element < 0 || element.element >= cables->nElements()) return;
        try {
            curve = curveOf(*cables, element.element, *state, std::max(1, parts));
        } catch (const std::exception&) {
            return; // the engine tells in its own step
        }
    }
    const Gl& gl = Gl::calls();
    drawLine(gl, curve);
    if (!wire) drawTube(gl, curve, element.radius);
}

} // namespace yade
