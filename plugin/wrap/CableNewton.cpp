// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableNewton.hpp"

#include "CableElement.hpp"
#include "LateError.hpp"

namespace yade {

YADE_PLUGIN((CableNewton))

void CableNewton::list() {
    BodyContainer& bodies = *scene->bodies;
    bodies.updateRealBodies();
    if (bodies.realBodies == seen) return;
    seen = bodies.realBodies;
    moved.clear();
    for (const Body::id_t id : seen)
        if (!CableElement::of(*bodies[id])) moved.push_back(id);
}

void CableNewton::action() {
    throwLate(*scene);
    BodyContainer& bodies = *scene->bodies;
    list();
    struct Swap { // the base class loops over realBodies; back again, whatever it throws
        BodyContainer& bodies;
        vector<Body::id_t>& listed;
        bool redirected;
        Swap(BodyContainer& b, vector<Body::id_t>& l) : bodies(b), listed(l), redirected(b.useRedirection) {
            bodies.realBodies.swap(listed);
            bodies.useRedirection = true;
        }
        ~Swap() {
            bodies.realBodies.swap(listed);
            bodies.useRedirection = redirected;
        }
    };
    {
        const Swap swapped(bodies, moved);
        NewtonIntegrator::action();
    }
    if (maxVelocitySq == 0) maxVelocitySq = .5; // nothing but cables: not a reason for the collider to run
}

} // namespace yade
