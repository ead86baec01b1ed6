// SPDX-License-Identifier: GPL-2.0-or-later
#include "LineDrawing.hpp"

#include "CableDrawing.hpp"
#include "LineEngine.hpp"
#include "Tube.hpp"

#include <algorithm>
#include <cmath>

namespace yade {

YADE_PLUGIN((GlExtra_Lines))

namespace {
    constexpr int ringSides = 24;
    const Vector3r ringColor(.35, .35, .35);

    struct Shown { // of a line
        vector<Vector3r> places;
        vector<Real> tension; // of its spans [N]
        Real radius, ring;    // [m]
    };

    vector<Shown> linesOf(const Scene& scene) {
        vector<Shown> all;
        for (const auto& engine : scene.engines) {
            auto* line = dynamic_cast<LineEngine*>(engine.get());
            if (!line) continue;
            try {
                all.push_back({line->points(), line->tension, line->diameter / 2, line->ringRadius});
            } catch (const std::exception&) { // it tells in its own step
            }
        }
        return all;
    }

    void drawSpans(const Shown& line, Real full) {
        for (size_t i = 0; i + 1 < line.places.size(); ++i) {
            const Vector3r way = line.places[i + 1] - line.places[i];
            if (way.norm() == 0) continue;
            const Vector3r color = tensionColor(full > 0 ? line.tension[i] / full : 0), along = way.normalized();
            const vector<Station> span {{line.places[i], along, color}, {line.places[i + 1], along, color}};
            drawThread(span);
            if (line.radius > 0) drawTube(span, line.radius);
        }
    }

    // Where it runs through a ring, this is seen along the mean of both spans' directions.
    void drawRing(const Shown& line, size_t i) {
        const auto direction = [&](size_t k) {
            const Vector3r way = line.places[k + 1] - line.places[k];
            return way.norm() > 0 ? Vector3r(way.normalized()) : Vector3r(Vector3r::Zero());
        };
        const Vector3r through = direction(i - 1) + direction(i);
        const Vector3r axis = through.norm() > 1e-6 ? Vector3r(through.normalized()) : Vector3r(Vector3r::UnitZ());
        const Vector3r side = axis.unitOrthogonal(), other = axis.cross(side);
        vector<Station> round;
        for (int k = 0; k <= ringSides; ++k) {
            const Real angle = 2 * M_PI * k / ringSides;
            round.push_back({line.places[i] + line.ring * (std::cos(angle) * side + std::sin(angle) * other),
                             std::cos(angle) * other - std::sin(angle) * side, ringColor});
        }
        drawThread(round);
        drawTube(round, std::max(line.radius, .1 * line.ring));
    }
} // namespace

void GlExtra_Lines::render() {
    vector<Shown> lines;
    {
        const PatientGuard guard;
        if (!guard || !scene) return;
        lines = linesOf(*scene);
    }
    Real full = Gl1_CableElement::fullTension;
    for (const Shown& line : lines)
        for (const Real tension : line.tension)
            if (!(Gl1_CableElement::fullTension > 0)) full = std::max(full, tension);
    for (const Shown& line : lines) {
        drawSpans(line, full);
        for (size_t i = 1; i + 1 < line.places.size() && line.ring > 0; ++i) drawRing(line, i);
    }
}

} // namespace yade
