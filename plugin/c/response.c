#include "ancf/response.h"
#include "ancf/mass.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double negligible = 1e-13;

struct ancf_responses {
    int n_elements;
    ancf_response* element; // (n_elements), n = 0: not made yet
    double (*work)[4];      // (n_dof)
};

ancf_error ancf_responses_create(ancf_responses** responses, const ancf_model* m) {
    ancf_responses* r = *responses = calloc(1, sizeof *r);
    if (!r) return ANCF_E_MEMORY;
    r->n_elements = m->n_elements;
    r->element = calloc((size_t)m->n_elements, sizeof *r->element);
    r->work = calloc((size_t)m->n_dof, sizeof *r->work);
    if (r->element && r->work) return ANCF_OK;
    ancf_responses_destroy(r);
    *responses = NULL;
    return ANCF_E_MEMORY;
}

void ancf_responses_destroy(ancf_responses* r) {
    if (!r) return;
    for (int e = 0; r->element && e < r->n_elements; ++e) {
        free((void*)r->element[e].dof);
        free((void*)r->element[e].column);
    }
    free(r->element);
    free(r->work);
    free(r);
}

// One unknown's column into work[.][k].
static void solve_column(ancf_responses* r, const ancf_model* m, int dof, int k) {
    double *force = m->work, *answer = m->work + 3 * m->stride;
    memset(m->work, 0, 6 * (size_t)m->stride * sizeof *m->work);
    force[dof] = 1.0;
    ancf_model_join(m, force);
    ancf_mass_solve(m, answer, force);
    for (int i = 0; i < m->n_dof; ++i) r->work[i][k] = answer[i];
}

static double largest_of(const double column[4]) {
    return fmax(fmax(fabs(column[0]), fabs(column[1])), fmax(fabs(column[2]), fabs(column[3])));
}

const ancf_response* ancf_responses_of(ancf_responses* r, const ancf_model* m, int element) {
    ancf_response* made = &r->element[element];
    if (made->dof) return made;
    int place[4], n = 0;
    double largest[4] = {0.0, 0.0, 0.0, 0.0};
    ancf_model_dofs(place, m, element);
    for (int k = 0; k < 4; ++k) {
        solve_column(r, m, place[k], k);
        for (int i = 0; i < m->n_dof; ++i) largest[k] = fmax(largest[k], fabs(r->work[i][k]));
    }
    memset(m->work, 0, 6 * (size_t)m->stride * sizeof *m->work);
    for (int i = 0; i < m->n_dof; ++i) {
        for (int k = 0; k < 4; ++k)
            if (fabs(r->work[i][k]) <= negligible * largest[k]) r->work[i][k] = 0.0;
        n += largest_of(r->work[i]) > 0.0;
    }
    int* dof = calloc((size_t)n + 1, sizeof *dof); // never empty: NULL says not made
    double(*column)[4] = calloc((size_t)n + 1, sizeof *column);
    if (!dof || !column) {
        free(dof);
        free(column);
        return NULL;
    }
    n = 0;
    for (int i = 0; i < m->n_dof; ++i) {
        if (largest_of(r->work[i]) == 0.0) continue;
        dof[n] = i;
        memcpy(column[n++], r->work[i], sizeof *column);
    }
    *made = (ancf_response) {n, dof, (const double(*)[4])column};
    return made;
}
