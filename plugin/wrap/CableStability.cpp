// SPDX-License-Identifier: GPL-2.0-or-later
// How long a step of the cables may be: known before the first, and looked at again before strains, speeds or O.dt make
// it too long.
#include "CableEngine.hpp"

#include "HollarsPhys.hpp"
#include "text.hpp"

extern "C" {
#include "ancf/stability.h"
#include "ancf/tension.h"
}

#include <cmath>

namespace yade {

namespace {
    constexpr Real rk4Reach = 1.39;      // its stable step against leapfrog's: 1.414 undamped, 1.393 with much damping
    constexpr Real contactReach = 2;     // O.dt against contactTimeStep() at most: 3.5 steps in a contact
    constexpr Real lookInterval = 10;    // steps between two looks at most
    constexpr Real strainInterval = 100; // between two looks at all strains at most

    enum Watched {
        STEPS,  // taken by this engine
        LOOK,   // number of the step that looks next
        STRAIN, // number of the step that looks at all strains at the latest
        SINCE,  // number of the step that `BOUND` is of
        BOUND,  // no strain is larger
        ROOM,   // strain up to which automatic steps are stable
        WATCHED
    };
} // namespace

void CableEngine::startWatch() {
    if (watched.size() != WATCHED) watched.assign(WATCHED, 0);
    watched[LOOK] = watched[STRAIN] = watched[STEPS];
    watched[ROOM] = std::max(watched[ROOM], strainReserve);
    shortest = *std::min_element(length.begin(), length.end());
    setLimit();
    watchedBodies = -1;
    watchedStep = 0;
}

void CableEngine::setLimit() {
    int element;
    substepLimit = stableStep(watched[ROOM], &element);
}

// Steps of the cable in this O.dt.
int CableEngine::stepsInside() const {
    if (integrator != "leapfrog") return 1;
    if (substeps > 0 || anyCoupled) return std::max(1, substeps);
    return std::max(1, static_cast<int>(std::min<Real>(std::ceil(theScene().dt / substepLimit), substepsMost + 1)));
}

// By how much strains may grow in a step, at the largest difference of speeds in what may touch.
Real CableEngine::strainGrowth(Real fastest) const {
    Real still = 0; // of the cables' first node
    for (int c = 0; c < 3; ++c) still = std::max(still, std::abs(velocity[c * getStride()]));
    const Real spread = std::max(ancf_speed_spread(model.get(), velocity.data()), fastest - still) + winchRate();
    return spread * theScene().dt / shortest;
}

// Before a step: looks at speeds and bodies every tenth one or earlier, at all strains when their bound leaves the room
// that the step has, and at the step itself when one of these or O.dt has changed.
void CableEngine::watch() {
    const Scene& s = theScene();
    const bool fresh = s.dt != watchedStep || static_cast<long>(s.bodies->size()) != watchedBodies;
    const Real now = watched[STEPS]++;
    if (!fresh && now < watched[LOOK]) return;
    if (!(s.dt > 0) || !std::isfinite(s.dt)) refuse(text("O.dt = ", s.dt, " s: must be finite and above 0"));
    if (fresh) listBodies();
    const Real fastest = checkFinite(), growth = strainGrowth(fastest);
    if (fresh) checkBodyContacts(fastest);
    watched[BOUND] += growth * (now - watched[SINCE]);
    watched[SINCE] = now;
    int strained = 0;
    if (fresh || now >= watched[STRAIN] || !(watched[BOUND] + growth <= watched[ROOM])) {
        watched[BOUND] = ancf_strain_max(model.get(), position.data(), &strained);
        watched[STRAIN] = now + strainInterval;
        const Real needed = watched[BOUND] + growth;
        if (needed > watched[ROOM] || (watched[ROOM] > strainReserve && needed < watched[ROOM] / 2)) {
            watched[ROOM] = std::max(strainReserve, 1.25 * needed);
            setLimit();
        }
        checkStep(strained);
    }
    const Real left = (watched[ROOM] - watched[BOUND]) / (2 * std::max(growth, 1e-12));
    watched[LOOK] = now + (fast ? 1 : std::floor(std::min(lookInterval, std::max<Real>(1, left))));
    if (fast) theScene().doSort = true; // what it meets in the step ahead is found when the collider runs in each
    watchedStep = s.dt;
    watchedBodies = static_cast<long>(s.bodies->size());
}

// The step against that which is stable at the largest strain now, where it cannot be divided.
void CableEngine::checkStep(int strained) {
    if (integrator == "implicit") return;
    const Scene& s = theScene();
    const int inside = stepsInside();
    if (inside > substepsMost)
        refuse(text("O.dt = ", s.dt, " s would take more than ", substepsMost,
                    " steps of the cables, which are stable up to ", substepLimit,
                    " s: use O.dt <= ", substepsMost * substepLimit));
    const Real largest = std::max(strainReserve, watched[BOUND]), step = s.dt / inside;
    int stiffest = 0;
    const Real leapfrog = stableStep(largest, &stiffest);
    const Real limit = integrator == "rk4" ? rk4Reach * leapfrog : leapfrog;
    if (step <= (1 + 1e-7) * limit) return;
    const string remedy = integrator == "rk4" ? ""
                          : anyCoupled ? " (a body that is carried off its centre, or guided, does not allow sub-steps)"
                                       : " or more substeps";
    refuse(text("at iteration ", s.iter, " the step of the cables, ", step, " s, is above the stable one, ", limit,
                " s, of element ", stiffest, " at strain ", largest, " (largest strain: ", watched[BOUND],
                " in element ", strained, "): use O.dt <= ", limit * inside, remedy));
}

// Contacts of HollarsMat between bodies, which the collider and NewtonIntegrator step in O.dt.
void CableEngine::checkBodyContacts(Real fastest) const {
    const Scene& s = theScene();
    const Real speed = std::max<Real>(1, fastest), limit = contactTimeStep(s, normalKind, speed);
    if (s.dt > contactReach * limit)
        refuse(text("O.dt = ", s.dt, " s is too long for contacts between bodies of HollarsMat that meet at ", speed,
                    " m/s, which would gain energy: use O.dt <= ", limit, " (ancf.timeStep())"));
}

Real CableEngine::criticalTimeStep() {
    followMaterials();
    if (!model) build();
    int element;
    const Real strained = std::max(strainReserve, ancf_strain_max(model.get(), position.data(), &element));
    return stableStep(strained, &element);
}

} // namespace yade
