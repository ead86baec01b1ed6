// SPDX-License-Identifier: GPL-2.0-or-later
#include "MaterialWatch.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace yade {

namespace {
    constexpr size_t atOnce = 1000; // looked at in a step; a scene with more materials waits for its turn
} // namespace

MaterialWatch& MaterialWatch::instance() {
    static MaterialWatch watch;
    return watch;
}

MaterialWatch::View::View(Material& material)
    : elastic(dynamic_cast<ElastMat*>(&material)), hollars(dynamic_cast<HollarsMat*>(&material)),
      frict(dynamic_cast<FrictMat*>(&material)) {}

MaterialWatch::Values MaterialWatch::View::values() const {
    if (const HollarsMat* m = hollars)
        return {m->young,         m->poisson, m->staticFriction,  m->kineticFriction, m->transitionVelocity,
                m->impactDamping, m->dashpot, m->normalStiffness, m->normalExponent};
    if (!elastic) return {};
    return {elastic->young, elastic->poisson, frict ? frict->frictionAngle : 0};
}

void MaterialWatch::add(const shared_ptr<Material>& material) {
    const std::lock_guard<std::mutex> lock(mutex);
    const auto [at, fresh] = numbers.insert({material.get(), known.size()});
    const View view(*material);
    const Known now = {material.get(), material, view, view.values()};
    if (fresh) known.push_back(now);
    else if (Known& old = known[at->second]; old.material.expired()) old = now; // at the same address
}

void MaterialWatch::look() {
    const std::lock_guard<std::mutex> lock(mutex);
    bool edited = false;
    for (size_t n = std::min(atOnce, known.size()); n > 0; --n) {
        if (next >= known.size()) next = 0;
        if (const auto material = known[next].material.lock()) {
            Known& one = known[next++];
            if (one.view.hollars) one.view.hollars->takeFrictionAngle();
            const Values now = one.view.values();
            if (std::memcmp(&now, &one.values, sizeof now) == 0) continue;
            one.values = now;
            edited = true;
        } else { // the last one takes its place
            numbers[known.back().key] = next;
            numbers.erase(known[next].key);
            known[next] = known.back();
            known.pop_back();
        }
    }
    if (edited) ++editions;
}

long MaterialWatch::mark(const Material& a, const Material& b) {
    uint64_t hash = 1469598103934665603u; // FNV-1a, by words
    for (const Material* each : {&a, &b})
        for (const Real value : View(const_cast<Material&>(*each)).values()) {
            uint64_t word;
            std::memcpy(&word, &value, sizeof word);
            hash = (hash ^ word) * 1099511628211u;
            hash ^= hash >> 32;
        }
    return static_cast<long>(hash >> 1); // never negative
}

} // namespace yade
