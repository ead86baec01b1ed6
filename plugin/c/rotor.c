#include "ancf/rotor.h"

#include <math.h>

static int not_negative(double x) { return isfinite(x) && x >= 0.0; }

ancf_error ancf_rotor_check(const ancf_rotor* rotor) {
    if (!isfinite(rotor->inertia) || !(rotor->inertia > 0.0)) return ANCF_E_INERTIA;
    return not_negative(rotor->viscous) && not_negative(rotor->dry) ? ANCF_OK : ANCF_E_BEARING;
}

double ancf_rotor_resistance(const ancf_rotor* rotor, double dt) { return rotor->inertia + dt * rotor->viscous; }

double ancf_rotor_step(double* friction, const ancf_rotor* rotor, double speed, double force, double dt) {
    const double impulse = rotor->inertia * speed + dt * force, bound = dt * rotor->dry;
    if (fabs(impulse) <= bound) {
        *friction = -impulse / dt;
        return 0.0;
    }
    *friction = impulse > 0.0 ? -rotor->dry : rotor->dry;
    return (impulse + dt * *friction) / ancf_rotor_resistance(rotor, dt);
}
