// SPDX-License-Identifier: GPL-2.0-or-later
// What the engine is made of, remembered so that a cable refused half way leaves nothing behind.
#include "CableEngine.hpp"

#include <tuple>

namespace yade {

auto CableEngine::parts() {
    return std::tie(nNodes, position, velocity, acceleration, ends, next, kind, length, ea, ei, rhoA, kelvinVoigt,
                    massDamping, elementIds, radius, segments, points, structure, selfContact, run, arc, closed,
                    sections, sectionMaterials, sectionBends, sectionYoung, sectionDensity, fixedNodes, clampedEnds,
                    followNodes, followIds, followAt, followEnds, followSlopes, slideNodes, slideAlong, slideAt,
                    carryNodes, carryIds, carryAt, carryReaction, loadNodes, loads, tiedNodes, tiedTo, lastStep);
}

namespace {
    template <class... T> std::tuple<T...> copyOf(const std::tuple<T&...>& parts) { return parts; }
} // namespace

struct CableEngine::Kept {
    decltype(copyOf(std::declval<CableEngine&>().parts())) parts;
};

void CableEngine::begin() {
    freedomsBefore.clear();
    kept = std::make_shared<Kept>(Kept {copyOf(parts())});
}

void CableEngine::commit() { kept.reset(); }

void CableEngine::rollback() {
    if (!kept) return;
    parts() = kept->parts;
    kept.reset();
    const auto& bodies = *theScene().bodies;
    for (const auto& [id, freedoms] : freedomsBefore)
        if (bodies.exists(id)) (*theScene().bodies)[id]->state->blockedDOFs = freedoms;
    standsFor.clear();
    changed();
}

} // namespace yade
