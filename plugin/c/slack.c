#include "slack.h"
#include "settle.h"

#include <math.h>
#include <stdlib.h>

static const double squeezed = 1e-3; // mean strain from which a compressed element is taken for slack

// Largest compression of a beam, as mean strain; 0: none.
static double compression(const ancf_model* m) {
    double most = 0.0;
    for (int e = 0; e < m->n_elements; ++e) {
        double square = 0.0;
        for (int c = 0; c < 3; ++c) {
            const double* x = m->x + c * m->stride;
            const double d = (x[m->ends[2 * e + 1]] - x[m->ends[2 * e]]) * m->inv_length[e];
            square += d * d;
        }
        if (!(m->element[e].kind & ANCF_SPRING)) most = fmax(most, 0.5 * (1.0 - square));
    }
    return most;
}

static double load_of(const ancf_model* m) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_nodes; ++i) sum += fabs(m->external[c * m->stride + i] + m->gravity[c] * m->weight[i]);
    return sum;
}

static double stiffest(const ancf_model* m) {
    double most = 0.0;
    for (int e = 0; e < m->n_elements; ++e) most = fmax(most, m->element[e].ea);
    return most;
}

static void soften(ancf_model* m, const double* real, double part) {
    for (int e = 0; e < m->n_elements; ++e) {
        m->element[e].ea = part * real[2 * e];
        m->ea_length[e] = part * real[2 * e + 1];
    }
}

bool ancf_hang(ancf_model* m, ancf_rest* rest) {
    enum { PARTS = 4 }; // of a decade
    const double most = compression(m);
    if (most <= squeezed) return true;
    double part = load_of(m) / (stiffest(m) * most);
    if (!(part > 0.0)) return true;
    double* real = malloc(2 * (size_t)m->n_elements * sizeof *real); // stiffnesses
    if (!real) return false;
    for (int e = 0; e < m->n_elements; ++e) {
        real[2 * e] = m->element[e].ea;
        real[2 * e + 1] = m->ea_length[e];
    }
    for (bool found = true; found && part < 1.0; part *= pow(10.0, 1.0 / PARTS)) {
        soften(m, real, part);
        found = ancf_settle(m, 1e-3, rest);
    }
    soften(m, real, 1.0);
    free(real);
    return true;
}
