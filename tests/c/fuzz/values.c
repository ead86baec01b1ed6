// Values, cables, solids at random.
#include "fuzz.h"

#include <float.h>
#include <limits.h>

double hostile_value(fuzz* f) {
    static const double pool[] = {0.0,     -0.0,     1.0,     -1.0,   NAN,    INFINITY, -INFINITY,
                                  DBL_MAX, -DBL_MAX, DBL_MIN, 5e-324, 1e-300, 1e-160,   1e-100,
                                  1e-30,   1e30,     1e99,    -1e99,  1e150,  1e300};
    enum { POOL = sizeof pool / sizeof *pool };
    if (by_chance(f, 0.7)) return pool[pick(f, POOL)];
    const double value = random_magnitude(&f->seed, 1e-20, 1e20);
    return by_chance(f, 0.5) ? value : -value;
}

void unit_vector(double n[3], fuzz* f) {
    double square;
    do {
        square = 0.0;
        for (int i = 0; i < 3; ++i) {
            n[i] = by_chance(f, 0.1) ? 0.0 : random_between(&f->seed, -1.0, 1.0);
            square += n[i] * n[i];
        }
    } while (square < 0.01);
    for (int i = 0; i < 3; ++i) n[i] /= sqrt(square);
}

int index_below(fuzz* f, int n) {
    static const int pool[] = {-1, -2, INT_MAX, INT_MIN, 0};
    if (!by_chance(f, f->chance)) return pick(f, n);
    return by_chance(f, 0.3) ? n : pool[pick(f, 5)];
}

bool all_finite(const double* value, int n) {
    for (int i = 0; i < n; ++i)
        if (!isfinite(value[i])) return false;
    return true;
}

ancf_normal any_normal_law(fuzz* f) {
    return (ancf_normal) {.kind = (ancf_normal_kind)pick(f, 3),
                          .stiffness = magnitude(f, 1.0, 1e9),
                          .exponent = by_chance(f, 0.5) ? 1.5 : between(f, 1.0, 3.0),
                          .damping = by_chance(f, 0.3) ? 0.0 : magnitude(f, 1e-3, 10.0)};
}

ancf_friction any_friction_law(fuzz* f) {
    ancf_friction law = {
        .kind = (ancf_friction_kind)pick(f, 3), .mu_k = between(f, 0.0, 1.0), .v0 = magnitude(f, 1e-6, 1e-1)};
    law.mu_s = by_chance(f, 0.3) ? law.mu_k : law.mu_k + between(f, 0.0, 0.5);
    return law;
}

ancf_normal good_normal_law(fuzz* f) {
    ancf_normal law;
    do law = any_normal_law(f);
    while (ancf_normal_check(&law));
    return law;
}

ancf_friction good_friction_law(fuzz* f) {
    ancf_friction law;
    do law = any_friction_law(f);
    while (ancf_friction_check(&law));
    return law;
}

static int any_kind(fuzz* f) {
    if (by_chance(f, f->chance)) return index_below(f, 64);
    return by_chance(f, 0.2) ? ANCF_SPRING : pick(f, 16) * 2;
}

static void join(built* b, fuzz* f, int shape) {
    const int n = b->def.n_elements, nodes = b->def.n_nodes;
    for (int e = 0; e < n; ++e) {
        b->ends[2 * e] = shape < 3 ? e : index_below(f, nodes);
        b->ends[2 * e + 1] = shape < 3 ? (e + 1) % nodes : index_below(f, nodes);
        if (shape == 3 && b->ends[2 * e] == b->ends[2 * e + 1] && !by_chance(f, f->chance))
            b->ends[2 * e + 1] = b->ends[2 * e] == 0;
        if (by_chance(f, f->chance)) b->ends[2 * e + pick(f, 2)] = index_below(f, nodes);
        const bool spring = (b->element[e].kind | b->element[(e + 1) % n].kind) & ANCF_SPRING;
        if (shape < 3 && (e + 1 < n || nodes == n) && !spring && by_chance(f, 0.8)) b->next[e] = (e + 1) % n;
        if (by_chance(f, f->chance)) b->next[e] = index_below(f, n);
    }
    if (n == 1 && b->next[0] == 0) b->next[0] = -1;
}

built any_build(fuzz* f) {
    const int n = 1 + pick(f, 6), shape = pick(f, 4); // in a row, twice as likely; a ring; joined anyhow
    const int nodes = shape < 2 || n == 1 ? n + 1 : shape == 2 ? n : 2 + pick(f, n);
    built b = build_start(nodes, n, (ancf_element) {0});
    const bool same = by_chance(f, 0.5);
    for (int e = 0; e < n; ++e) {
        ancf_element* el = &b.element[e];
        *el = (ancf_element) {.kind = any_kind(f),
                              .length = magnitude(f, 1e-3, 1.0),
                              .ea = magnitude(f, 1.0, 1e6),
                              .rho_a = magnitude(f, 1e-4, 1.0),
                              .damping = by_chance(f, 0.5) ? 0.0 : magnitude(f, 1e-7, 1e-3),
                              .drag = by_chance(f, 0.7) ? 0.0 : magnitude(f, 1e-2, 1e3)};
        if (!(el->kind & ANCF_SPRING) && by_chance(f, 0.8)) el->ei = magnitude(f, 1e-8, 1e-2);
        if (same && e > 0 && !by_chance(f, f->chance)) *el = b.element[0];
    }
    join(&b, f, shape);
    for (int i = 0; i < nodes; ++i) b.mass[i] = by_chance(f, 0.7) ? 0.0 : magnitude(f, 1e-3, 1.0);
    for (int i = 0; i < b.n_dof; ++i) b.hold[i] = by_chance(f, 0.15) ? ANCF_HELD : ANCF_FREE;
    double along[3];
    for (int i = 0; i < nodes; ++i) {
        unit_vector(along, f);
        along[0] = fabs(along[0]) + 1.0;
        const double scale = b.element[i < n ? i : n - 1].length / 2.0;
        for (int c = 0; c < 3; ++c) {
            const double before = i > 0 ? b.x[c * b.stride + i - 1] : 0.0;
            b.x[c * b.stride + i] = by_chance(f, f->chance) ? hostile_value(f) : before + scale * along[c];
        }
    }
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b.n_dof; ++i) {
            if (i >= nodes) b.x[c * b.stride + i] = between(f, -1.0, 1.0);
            b.v[c * b.stride + i] = by_chance(f, 0.3) ? 0.0 : between(f, -1.0, 1.0);
        }
    for (int e = 0; e < n; ++e) // slopes along the elements, more or less
        for (int c = 0; c < 3 && !by_chance(f, 0.2); ++c) {
            const int p = b.ends[2 * e], q = b.ends[2 * e + 1];
            if (p < 0 || q < 0 || p >= nodes || q >= nodes) continue;
            const double d = (b.x[c * b.stride + q] - b.x[c * b.stride + p]) / b.element[e].length;
            for (int k = 0; k < 2; ++k) b.x[c * b.stride + nodes + k * n + e] = d + between(f, -0.1, 0.1);
        }
    for (int e = 0; e < n; ++e)
        for (int c = 0; c < 3 && b.next[e] >= 0 && b.next[e] < n; ++c) {
            b.x[c * b.stride + nodes + b.next[e]] = b.x[c * b.stride + nodes + n + e];
            b.v[c * b.stride + nodes + b.next[e]] = b.v[c * b.stride + nodes + n + e];
        }
    b.def.element = b.element;
    b.def.ends = b.ends;
    b.def.next = b.next;
    b.def.mass = by_chance(f, 0.2) ? NULL : b.mass;
    b.def.hold = by_chance(f, 0.2) ? NULL : b.hold;
    for (int i = 0; i < 2 && by_chance(f, 0.2); ++i) {
        unit_vector(along, f);
        build_slide(&b, pick(f, nodes), along);
    }
    return b;
}

bool any_model(built* b, fuzz* f) {
    *b = any_build(f);
    int where;
    b->def.slide = b->slide;
    if (!ancf_model_create(&b->m, &b->def, b->x, b->v, &where)) return true;
    build_free(b);
    return false;
}

int any_knot(fuzz* f, const ancf_model* m) { return m->ends[pick(f, 2 * m->n_elements)]; }

ancf_solid any_solid(fuzz* f, ancf_groove* groove) {
    ancf_solid s = {.kind = (ancf_solid_kind)pick(f, 5), .sense = pick(f, 3) - 1, .groove = groove};
    vector_between(s.center, f, 1.0);
    unit_vector(s.axis[0], f);
    const int least = fabs(s.axis[0][0]) < 0.6 ? 0 : 1;
    double along = s.axis[0][least], size;
    for (int i = 0; i < 3; ++i) s.axis[1][i] = (i == least) - along * s.axis[0][i];
    size = sqrt(s.axis[1][0] * s.axis[1][0] + s.axis[1][1] * s.axis[1][1] + s.axis[1][2] * s.axis[1][2]);
    for (int i = 0; i < 3; ++i) s.axis[1][i] /= size;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        s.axis[2][i] = s.axis[0][j] * s.axis[1][k] - s.axis[0][k] * s.axis[1][j];
        s.size[i] = magnitude(f, 1e-3, 1.0);
        vector_between(s.corner[i], f, 1.0);
    }
    *groove = (ancf_groove) {.radius = magnitude(f, 1e-2, 1.0),
                             .floor = by_chance(f, 0.5) ? 0.0 : magnitude(f, 1e-3, 1e-1),
                             .fillet = by_chance(f, 0.2) ? 0.0 : magnitude(f, 1e-3, 1e-2),
                             .slope = between(f, 0.2, 1.5),
                             .height = by_chance(f, 0.2) ? 0.0 : magnitude(f, 1e-2, 1e-1),
                             .land = by_chance(f, 0.3) ? 0.0 : magnitude(f, 1e-3, 1e-2)};
    return s;
}

ancf_cover* any_cover(fuzz* f, const ancf_model* m, int most, int kinds) {
    ancf_cover* cover = calloc((size_t)m->n_elements, sizeof *cover);
    const bool whole = by_chance(f, 0.5);
    double arc = 0.0;
    for (int e = 0; e < m->n_elements; ++e) {
        cover[e] = (ancf_cover) {.radius = by_chance(f, 0.1) ? 0.0 : random_magnitude(&f->seed, 1e-4, 3e-1),
                                 .segments = 1 + pick(f, most),
                                 .points = by_chance(f, 0.2),
                                 .kind = pick(f, kinds),
                                 .mask = by_chance(f, 0.9) ? 1 : 2,
                                 .structure = pick(f, 2),
                                 .own = by_chance(f, 0.7),
                                 .run = whole ? 0 : e,
                                 .arc = whole ? arc : 0.0,
                                 .owns = {true, by_chance(f, 0.5)}};
        if (by_chance(f, f->chance)) cover[e].radius = random_magnitude(&f->seed, 1e-90, 1e90);
        arc += m->element[e].length;
    }
    return cover;
}

double any_step(fuzz* f, const ancf_model* m) {
    int element;
    const double strain = ancf_strain_max(m, m->x, &element),
                 stable = ancf_critical_step(m, 2.0 * strain + 1.0, &element);
    need(element >= 0 && element < m->n_elements);
    const bool bears = isfinite(stable) && stable > 0.0;
    if (f->chance == 0.0 && strain < 1e3) need(bears);
    return by_chance(f, f->chance) || !bears ? hostile_value(f) : 0.1 * stable;
}

void spoil(fuzz* f, const built* b) {
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b->n_dof; ++i) {
            if (by_chance(f, f->chance / 4.0)) b->x[c * b->stride + i] = hostile_value(f);
            if (by_chance(f, f->chance / 4.0)) b->v[c * b->stride + i] = hostile_value(f);
        }
    build_share(b, b->x);
    build_share(b, b->v);
}
