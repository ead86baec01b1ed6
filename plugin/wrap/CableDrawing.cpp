// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableDrawing.hpp"

#include "CableEngine.hpp"
#include "Tube.hpp"

#include <chrono>
#include <map>

namespace yade {

YADE_PLUGIN((Gl1_CableElement))

Real Gl1_CableElement::fullTension = 0;
int Gl1_CableElement::parts = 8;

namespace {
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
                             tensionColor(full > 0 ? tension / full : 0)});
        }
        return curve;
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
        if (cables->kind[element.element] & ANCF_WOUND) return;
        try {
            curve = curveOf(*cables, element.element, *state, std::max(1, parts));
        } catch (const std::exception&) {
            return; // the engine tells in its own step
        }
    }
    drawThread(curve);
    if (!wire) drawTube(curve, element.radius);
}

} // namespace yade
