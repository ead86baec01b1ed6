#include "ancf/elastic.h"
#include "account.h"
#include "tile.h"

// Where a field has the forces on a tile's slopes.
static void put_slopes(ancf_fields* k, const ancf_model* m, const ancf_tile* t, double* field) {
    for (int c = 0; c < 3; ++c) {
        k->f0[c] = field + c * m->stride + m->n_nodes + t->begin;
        k->f1[c] = k->f0[c] + m->n_elements;
    }
}

void ancf_elastic_force(ancf_model* m, double* force, const double* x, const double* v) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE];
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        ancf_fields k = ancf_tile_fields(m, t, x, v, way, wayv);
        put_slopes(&k, m, t, force);
        ancf_kernel(&k, t->kind, t->bending, t->damped);
    }
    ancf_tile_gather(force, m, 0, m->n_nodes);
}

void ancf_elastic_energy(double* axial, double* bending, const ancf_model* m, const double* x, int begin, int end) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE];
    ancf_energies one;
    *axial = *bending = 0.0;
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        ancf_tile part = *t;
        if (part.begin < begin) part.begin = begin;
        if (part.end > end) part.end = end;
        if (part.begin >= part.end) continue;
        ancf_fields k = ancf_tile_fields(m, &part, x, x, way, wayv);
        k.inv_length = m->inv_length + part.begin;
        k.ea = m->ea_length + part.begin;
        k.ei = m->ei_length + part.begin;
        k.eta = m->damping + part.begin;
        ancf_kernel_energy(&one, &k, t->kind, t->bending);
        *axial += one.axial;
        *bending += one.bending;
    }
}

static bool slows(const ancf_tile* t) { return t->damped || t->kind & ANCF_SPRING; }

// Where Kelvin-Voigt forces of a tile are put: in m->work, those on slopes where a field has them, those on nodes
// behind the field.
static ancf_account account_of(const ancf_model* m, const ancf_tile* t) {
    ancf_account account;
    for (int c = 0; c < 3; ++c) {
        account.f0[c] = m->work + c * m->stride + m->n_nodes + t->begin;
        account.f1[c] = account.f0[c] + m->n_elements;
        account.fd[c] = m->work + 3 * m->stride + c * m->n_elements + t->begin;
    }
    return account;
}

void ancf_elastic_force_booked(ancf_books* books, ancf_model* m, double* force, const double* x, const double* v) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE];
    *books = (ancf_books) {0.0, 0.0};
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        ancf_fields k = ancf_tile_fields(m, t, x, v, way, wayv);
        ancf_account account = account_of(m, t);
        put_slopes(&k, m, t, force);
        ancf_kernel_booked(&account, &k, t->kind, t->bending, t->damped);
        books->elastic += account.elastic;
        books->power += account.power;
    }
    ancf_tile_gather(force, m, 0, m->n_nodes);
}

double ancf_elastic_power(const ancf_model* m, const double* v) {
    double wayv[3][ANCF_TILE], sum = 0.0, power;
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        if (!slows(t)) continue;
        const ancf_account account = account_of(m, t);
        ancf_fields k = {.n = t->end - t->begin};
        for (int c = 0; c < 3; ++c) {
            k.f0[c] = account.f0[c];
            k.f1[c] = account.f1[c];
            k.fd[c] = account.fd[c];
        }
        ancf_tile_rates(&k, m, t, v, wayv);
        ancf_kernel_power(&power, &k);
        sum += power;
    }
    return sum;
}

double ancf_damping_power(const ancf_model* m, const double* x, const double* v) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE], force[18][ANCF_TILE], sum = 0.0;
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        if (!slows(t)) continue;
        ancf_fields k = ancf_tile_fields(m, t, x, v, way, wayv);
        ancf_account account;
        for (int c = 0; c < 3; ++c) {
            k.f0[c] = force[c];
            k.f1[c] = force[3 + c];
            k.fd[c] = force[6 + c];
            account.f0[c] = force[9 + c];
            account.f1[c] = force[12 + c];
            account.fd[c] = force[15 + c];
        }
        ancf_kernel_booked(&account, &k, t->kind, t->bending, t->damped);
        sum -= account.power;
    }
    return sum;
}
