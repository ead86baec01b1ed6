#include "ancf/spool.h"

#include "ancf/mass.h"
#include "internal.h"

#include <float.h>
#include <math.h>

enum { ROUNDS = 60 };

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void at(double value[3], const ancf_model* m, const double* field, int node) {
    for (int c = 0; c < 3; ++c) value[c] = field[c * m->stride + node];
}

static void put(double* field, const ancf_model* m, int node, const double value[3]) {
    for (int c = 0; c < 3; ++c) field[c * m->stride + node] = value[c];
}

// The other node of an element.
static int far_of(const ancf_model* m, int element, int node) {
    return m->ends[2 * element] == node ? m->ends[2 * element + 1] : m->ends[2 * element];
}

// The first element as it is at a time.
typedef struct {
    const ancf_element* el;
    int node;             // beyond it
    double x0[3], x1[3];  // exit, node [m]
    double v0[3], v1[3];  // [m/s]
    double way[3], d[3];  // x1 - x0, over the unstressed length
    double length, along; // unstressed, |x1 - x0| [m]
    double half;          // rho A/2 [kg/m]
} first;

static first first_of(const ancf_spool* s, const ancf_model* m) {
    first f = {.el = &m->element[s->element], .node = far_of(m, s->element, s->node)};
    f.length = f.el->length;
    f.half = f.el->rho_a / 2.0;
    at(f.x0, m, m->x, s->node);
    at(f.x1, m, m->x, f.node);
    at(f.v0, m, m->v, s->node);
    at(f.v1, m, m->v, f.node);
    for (int c = 0; c < 3; ++c) {
        f.way[c] = f.x1[c] - f.x0[c];
        f.d[c] = f.way[c] / f.length;
    }
    f.along = sqrt(dot(f.way, f.way));
    return f;
}

double ancf_spool_length(const ancf_spool* s, const ancf_model* m) { return m->element[s->element].length + s->beyond; }

// ---------------------------------------------------------------- how much is fed

// What is known before a step of the force that the drum must exert in it.
typedef struct {
    double ea, damping; // [N], [s]
    double length;      // unstressed, now [m]
    double way, rate;   // distance of the two nodes at the end of the step, and its rate [m], [m/s]
    double steady;      // of weight and acceleration of the half element at the exit [N]
    double inertia;     // of that half and of the drum [kg]
    double before;      // rate of feed in the last step [m/s]
    double step, kick;  // [s]
} pull;

static double tension_at(const pull* p, double u) {
    const double length = p->length + p->step * u, stretch = p->way / length;
    if (!(stretch > 1.0)) return 0.0;
    return fmax(0.0, p->ea * (stretch - 1.0 + p->damping * (p->rate - stretch * u) / length));
}

static double needed(const pull* p, double u) {
    return tension_at(p, u) + p->steady - p->inertia * (u - p->before) / p->kick;
}

// The rate above u at which the drum needs no more than a force: by Newton's method, from below as it falls convexly.
static double rate_for(const pull* p, double force, double u) {
    for (int round = 0; round < ROUNDS; ++round) {
        const double off = needed(p, u) - force, by = 1e-7 * (fabs(p->length) / p->step + fabs(u));
        const double slope = (needed(p, u + by) - needed(p, u)) / by;
        if (!(off > 0.0) || !(slope < 0.0)) break;
        const double more = -off / slope;
        u += more;
        if (!(more > 1e-14 * fabs(u))) break;
    }
    return u;
}

// What the winch asks for in a step, as a rate of the length outside [m/s].
static double asked(const ancf_spool* s, double outside, double step) {
    const double out = -s->law.speed * step;
    const double fed =
        out < 0.0 ? fmin(0.0, fmax(out, s->law.least - outside)) : fmax(0.0, fmin(out, s->law.most - outside));
    return fed / step;
}

static double decide(ancf_spool* s, const pull* p, double outside) {
    const double wish = asked(s, outside, p->step), force = needed(p, wish);
    if (wish < 0.0 && force <= s->law.force) {
        s->does = ANCF_DRAWS;
        return wish;
    }
    if (wish < 0.0) {
        const double u = rate_for(p, s->law.force, wish);
        if (u < 0.0) {
            s->does = ANCF_STRAINS;
            return u;
        }
    }
    const double held = fmax(0.0, wish);
    if (needed(p, held) <= s->law.brake) {
        s->does = held > 0.0 ? ANCF_DRAWS : ANCF_HOLDS;
        return held;
    }
    const double u = rate_for(p, s->law.brake, held), most = fmax(0.0, s->capacity - outside) / p->step;
    s->does = u < most ? ANCF_SLIPS : ANCF_HOLDS;
    return fmin(u, most);
}

static pull pull_of(const ancf_spool* s, const ancf_model* m, const first* f, const ancf_time* time) {
    double p0[3], p1[3], ahead[3], steady = 0.0;
    at(p0, m, m->free, s->node);
    at(p1, m, m->free, f->node);
    const double kick = ancf_kick(time);
    for (int c = 0; c < 3; ++c) {
        ahead[c] = f->way[c] + time->step * (p1[c] - p0[c]);
        steady += f->way[c] * (m->gravity[c] - (p0[c] - f->v0[c]) / kick);
    }
    const double way = sqrt(dot(ahead, ahead)), along = f->along + DBL_MIN;
    double rate = 0.0;
    for (int c = 0; c < 3; ++c) rate += ahead[c] * (p1[c] - p0[c]) / (way + DBL_MIN);
    return (pull) {.ea = f->el->ea,
                   .damping = f->el->damping,
                   .length = f->length,
                   .way = way,
                   .rate = rate,
                   .steady = f->half * f->length / along * steady,
                   .inertia = f->half * f->along + s->inertia,
                   .before = s->rate,
                   .step = time->step,
                   .kick = kick};
}

// ---------------------------------------------------------------- one step

// A node's new velocity where it is free, and the force that stands for what it did: mass before, in the middle, after.
static void move(double v1[3], ancf_model* m, int node, const double v0[3], const double impulse[3], double before,
                 double now, double after, double kick) {
    for (int c = 0; c < 3; ++c) {
        const int i = c * m->stride + node;
        if (!m->hold[node]) v1[c] = (before * v0[c] + kick * m->f[i] + impulse[c]) / after;
        m->f[i] += (impulse[c] - (after * v1[c] - before * v0[c]) + now * (v1[c] - v0[c])) / kick;
        m->a[i] = (v1[c] - v0[c]) / kick;
    }
    put(m->free, m, node, v1);
    ancf_mass_lend(m, node, after);
}

// Work of the drum, and what flows, at the positions of the step's start; p0, p1: velocities behind it.
static void book(ancf_spool* s, const ancf_model* m, const first* f, const ancf_time* time, double u,
                 const double p0[3], const double p1[3]) {
    const double kick = ancf_kick(time), part = time->last / (time->last + time->step);
    const double mean = part * s->rate + (1.0 - part) * u;
    const double* tensions = m->pull + s->element;
    double on[3], z2 = 0.0, along = 0.0, z = 0.0, w2 = 0.0, v2 = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double v0 = f->v0[c] + part * (p0[c] - f->v0[c]), v1 = f->v1[c] + part * (p1[c] - f->v1[c]);
        const double turn = v1 - v0 - mean * f->d[c], w = v0 + mean * f->d[c];
        on[c] = tensions[c * m->n_elements];
        z2 += turn * turn;
        z += f->way[c] * turn;
        along += f->way[c] * (m->gravity[c] - (p0[c] - f->v0[c]) / kick);
        w2 += w * w;
        v2 += v0 * v0;
    }
    const double tension = sqrt(dot(on, on)), d2 = dot(f->d, f->d), strain = fmax(0.0, sqrt(d2) - 1.0),
                 stored = 0.5 * f->el->ea * strain * strain;
    const double flow = f->half * f->length * d2; // mass of what flows [kg]
    const double steady = f->half * (along - mean * z / f->length);
    s->tension = tension + (steady - flow * (u - s->rate) / kick) / sqrt(d2 + DBL_MIN);
    const double force = tension + stored + steady + f->half * (0.5 * z2 - mean * mean * d2);
    s->work += s->ahead + 0.5 * flow * (mean * mean - s->rate * s->rate) - 0.5 * force * time->last * s->rate;
    s->ahead = 0.5 * flow * (u * u - mean * mean) - 0.5 * force * time->step * u;
    s->kinetic = 0.5 * f->half * f->length * (w2 - v2);
}

void ancf_spool_feed(ancf_spool* s, ancf_model* m, const ancf_time* time) {
    const first f = first_of(s, m);
    const pull p = pull_of(s, m, &f, time);
    const double kick = p.kick, u = decide(s, &p, f.length + s->beyond);
    s->next = f.length + time->step * u;
    const double before = -0.5 * time->last * s->rate, after = 0.5 * time->step * u, passed = after - before;
    const double part = time->last / (time->last + time->step), mass1 = ancf_mass_of_node(m, f.node),
                 mass0 = ancf_mass_of_node(m, s->node);
    double p0[3], p1[3], give[3], take[3];
    at(p0, m, m->free, s->node);
    at(p1, m, m->free, f.node);
    for (int c = 0; c < 3; ++c)
        give[c] = f.half * (passed * (f.v0[c] + part * (p0[c] - f.v0[c])) + passed * passed / kick * f.d[c]);
    move(p1, m, f.node, f.v1, give, mass1 + f.half * before, mass1, mass1 + f.half * after, kick);
    // The flow's momentum at the middle of the step, with the mean way: (rho A/2) u (way + step (p1 - p0)/2).
    const double lent = m->hold[s->node] ? 0.0 : 0.5 * f.half * u * time->step;
    for (int c = 0; c < 3; ++c) {
        const double rest = f.half * u * (f.way[c] + 0.5 * time->step * p1[c]);
        take[c] = s->flow[c] - give[c] - rest;
        if (m->hold[s->node]) take[c] += 0.5 * f.half * u * time->step * p0[c];
    }
    move(p0, m, s->node, f.v0, take, mass0 - f.half * before, mass0, mass0 - f.half * after - lent, kick);
    ancf_mass_lend(m, s->node, mass0 - f.half * after);
    for (int c = 0; c < 3; ++c) s->flow[c] = f.half * u * (f.way[c] + 0.5 * time->step * (p1[c] - p0[c]));
    book(s, m, &f, time, u, p0, p1);
    s->rate = u;
}

// What feeding adds to the rate of the element's way.
static void note_fed(const ancf_spool* s, ancf_model* m) {
    const first f = first_of(s, m);
    for (int c = 0; c < 3; ++c) m->fed[c * m->n_elements + s->element] = s->rate * f.d[c];
}

void ancf_spool_end(const ancf_spool* s, ancf_model* m) {
    ancf_model_set_length(m, s->element, s->next);
    ancf_model_set_length(m, s->store, s->both - s->next);
    note_fed(s, m);
}

ancf_error ancf_spool_join(const ancf_spool* s, ancf_model* m) {
    const ancf_error error = ancf_model_feed(m, s->element);
    if (!error) note_fed(s, m);
    return error;
}

void ancf_spool_momentum(double p[3], const ancf_spool* s, const ancf_model* m, double last) {
    const first f = first_of(s, m);
    for (int c = 0; c < 3; ++c) p[c] = s->flow[c] - 0.5 * f.half * s->rate * last * (f.v1[c] - f.v0[c]);
}

// ---------------------------------------------------------------- nodes that come and go

// Energy of springs and lumps from the exit on, with a node between or none: the exit's, then one or two elements of
// the lengths l, at places x and velocities v.
static double energy_of(const ancf_spool* s, const ancf_model* m, const ancf_element* el, int n, const double l[2],
                        double x[3][3], double v[3][3]) {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) {
        double way[3], w[3];
        for (int c = 0; c < 3; ++c) {
            way[c] = x[k + 1][c] - x[k][c];
            w[c] = v[k][c] + (k == 0 ? s->rate * way[c] / l[0] : 0.0);
        }
        const double strain = fmax(0.0, sqrt(dot(way, way)) / l[k] - 1.0), mass = 0.5 * el->rho_a * l[k];
        sum += 0.5 * el->ea * strain * strain * l[k];
        sum += 0.5 * mass * (dot(w, w) + dot(v[k + 1], v[k + 1]));
        sum -= mass * (dot(m->gravity, x[k]) + dot(m->gravity, x[k + 1]));
    }
    return sum;
}

static void copy(double to[3], const double from[3]) {
    for (int c = 0; c < 3; ++c) to[c] = from[c];
}

// A free exit takes the momentum that is given to it besides what flows; energy: gained so far [J].
static void settle(ancf_knotting* node, ancf_spool* s, const ancf_model* m, const first* f, const double way[3],
                   const double v1[3], double mass, double last) {
    const double half_step = 0.5 * last, lump = f->half * f->length;
    copy(node->exit, f->v0);
    if (m->hold[s->node]) return;
    for (int c = 0; c < 3; ++c) {
        const double given = mass * f->v0[c] + s->flow[c];
        node->exit[c] =
            (given - f->half * s->rate * (way[c] - half_step * v1[c])) / (mass + f->half * s->rate * half_step);
        s->flow[c] = given - mass * node->exit[c];
    }
    node->energy += 0.5 * (ancf_mass_of_node(m, s->node) - lump) * (dot(node->exit, node->exit) - dot(f->v0, f->v0));
}

void ancf_spool_split(ancf_knotting* node, ancf_spool* s, const ancf_model* m, double length, double last) {
    const first f = first_of(s, m);
    const double first_length = f.length - length, xi = first_length / f.length, spare = f.along - f.length;
    // The tension rises along the element by what its middle part needs: the node is where it keeps its acceleration.
    double rise = 0.0;
    for (int c = 0; c < 3; ++c)
        rise += f.half * f.length * (m->gravity[c] - m->a[c * m->stride + f.node]) * f.way[c] / f.along;
    double more = spare > 0.0 ? rise / f.el->ea : 0.0; // strain of the part at the exit, over that of the other
    more = fmax(-spare / length, fmin(spare / first_length, more));
    const double near = first_length * (f.along / f.length + more * length / f.length);
    const double middle = f.length - 0.5 * last * s->rate; // length at the velocities' time
    const double mass = ancf_mass_of_node(m, s->node) + f.half * (f.length - middle - length);
    double x[3][3], v[3][3], way[3];
    for (int c = 0; c < 3; ++c) {
        const double d = (f.way[c] - 0.5 * last * (f.v1[c] - f.v0[c])) / middle, w = f.v0[c] + s->rate * d;
        way[c] = near * f.way[c] / f.along;
        node->x[c] = f.x0[c] + way[c];
        node->v[c] = w + xi * (f.v1[c] - w);
        s->flow[c] += f.half * (length * f.v0[c] + (middle - length) * f.v1[c] - middle * node->v[c]);
    }
    copy(x[0], f.x0);
    copy(v[0], f.v0);
    copy(x[1], f.x1);
    copy(v[1], f.v1);
    node->energy = -energy_of(s, m, f.el, 1, (double[]) {f.length, 0.0}, x, v);
    settle(node, s, m, &f, way, node->v, mass, last);
    copy(v[0], node->exit);
    copy(x[1], node->x);
    copy(v[1], node->v);
    copy(x[2], f.x1);
    copy(v[2], f.v1);
    node->energy += energy_of(s, m, f.el, 2, (double[]) {first_length, length}, x, v);
    s->beyond += length;
    s->next = first_length;
}

void ancf_spool_merge(ancf_knotting* node, ancf_spool* s, const ancf_model* m, int second, double last) {
    const first f = first_of(s, m);
    const int end = far_of(m, second, f.node);
    const double length = m->element[second].length, middle = f.length - 0.5 * last * s->rate, all = middle + length;
    double x[3][3], v[3][3], way[3], beyond[3];
    copy(x[0], f.x0);
    copy(v[0], f.v0);
    copy(x[1], f.x1);
    copy(v[1], f.v1);
    at(x[2], m, m->x, end);
    at(v[2], m, m->v, end);
    for (int c = 0; c < 3; ++c) {
        way[c] = x[2][c] - x[0][c];
        beyond[c] = x[2][c] - x[1][c];
    }
    // A chord is shorter than two: the drum takes what is over, so that the strain stays what it was in their mean.
    const double ways = f.along + sqrt(dot(beyond, beyond)), whole = f.length + length;
    const double over = ways > whole ? whole * (1.0 - sqrt(dot(way, way)) / ways) : 0.0;
    const double xi = middle / all, mass1 = ancf_mass_of_node(m, end), more = f.half * (middle - over),
                 mass1_after = mass1 + more;
    const double mass = ancf_mass_of_node(m, s->node) + f.half * (f.length - middle + length + over);
    node->energy = -energy_of(s, m, f.el, 2, (double[]) {f.length, length}, x, v);
    for (int c = 0; c < 3; ++c) {
        const double d = (way[c] - 0.5 * last * (v[2][c] - v[0][c])) / (all - over), w = v[0][c] + s->rate * d;
        const double off = v[1][c] - (w + xi * (v[2][c] - w)); // the element can have no such velocity
        const double after = v[2][c] + more * off / mass1_after;
        node->x[c] = x[2][c];
        node->v[c] = m->hold[end] ? v[2][c] : after;
        s->flow[c] += f.half * (all * v[1][c] - (length + over) * v[0][c]) + mass1 * v[2][c] - mass1_after * after;
    }
    node->energy += 0.5 * (mass1 - f.half * length) * (dot(node->v, node->v) - dot(v[2], v[2]));
    node->energy += 2.0 * f.half * over * (0.5 * dot(f.v0, f.v0) - dot(m->gravity, f.x0));
    settle(node, s, m, &f, way, node->v, mass, last);
    copy(v[0], node->exit);
    copy(x[1], x[2]);
    copy(v[1], node->v);
    s->next = whole - over;
    node->energy += energy_of(s, m, f.el, 1, (double[]) {s->next, 0.0}, x, v);
    s->beyond -= length;
}
