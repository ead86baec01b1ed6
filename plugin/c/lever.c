// Two cables touch at a radius from each centreline. Forces act on the centrelines, so friction f leaves a moment D x f
// with what lies between them, D. Where it bends a cable, its slope g takes it: a couple m across the tangent is an
// impulse m x g/|g|^2 on the slope. Each cable gets what is across its tangent t of one vector, in proportion to its
// radius r,
//
//     m = r (I - t t^T) lambda,   sum of both m = G lambda = -D x f.
//
// What is slip is what these impulses do work on: D x G^-1 (sum of r times the turning g x g'/|g|^2) besides the
// centrelines' velocities, which is that of the surfaces if the cables turn as one. So friction stays implicit and
// takes energy at any couple. A cable has no twist to take what is along its tangent; for two that are nearly parallel,
// G^-1 would make up for it by large couples against each other, and is left out smoothly.
#include "lever.h"

#include <math.h>
#include <string.h>

// Part of both radii below which the smallest part of G counts less and less: cables of one thickness within 26
// degrees.
static const double smallest = 0.05;

// Couples move the centrelines too, each time by much less.
enum { PASSES = 20 };

// Part of the largest moment that is left when passes end.
static const double rounding = 1e-16;

static void unit(double t[3], const double v[3]) {
    const double size = sqrt(ancf_dot(v, v));
    for (int i = 0; i < 3; i++) t[i] = size > 0.0 ? v[i] / size : 0.0;
}

static void add_outer(double A[9], double factor, const double e[3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) A[3 * i + j] += factor * e[i] * e[j];
}

// G^-1, from the eigenvectors of G: across both tangents, and two in their plane.
void ancf_lever_prepare(const ancf_table* t, ancf_contact* c) {
    double a[3], b[3], across[3], e[3], other[3];
    const int thick = c->radius[1] > c->radius[0];
    const double r = c->radius[thick], q = c->radius[!thick], both = r + q;
    unit(a, t->place[c->side[thick].place].slope);
    unit(b, t->place[c->side[!thick].place].slope);
    ancf_cross(across, a, b);
    const double sine2 = ancf_dot(across, across), cosine = ancf_dot(a, b);
    const double apart = sqrt(fmax(0.25 * both * both - r * q * sine2, 0.0));
    const double large = 0.5 * both + apart, small = r * q * sine2 / large;
    for (int i = 0; i < 3; i++) e[i] = (r - small) * a[i] + q * cosine * b[i];
    unit(e, ancf_dot(e, e) > 1e-20 * both * both ? e : a);
    ancf_cross(other, across, e);
    unit(other, other);
    const double part = small / (smallest * both), inverse = part < 1.0 ? part / (smallest * both) : 1.0 / small;
    memset(c->lever, 0, sizeof c->lever);
    for (int i = 0; i < 3; i++) c->lever[4 * i] = 1.0 / both;
    add_outer(c->lever, inverse - 1.0 / both, e);
    add_outer(c->lever, 1.0 / large - 1.0 / both, other);
}

// Impulses on both slopes by G^-1 of a moment.
static void couples(double w[2][3], const ancf_table* t, const ancf_contact* c, const double moment[3]) {
    double lambda[3];
    ancf_multiply(lambda, c->lever, moment);
    for (int s = 0; s < 2; ++s) {
        const double* slope = t->place[c->side[s].place].slope;
        const double size = c->radius[s] / ancf_dot(slope, slope);
        ancf_cross(w[s], slope, lambda); // against the moment
        for (int i = 0; i < 3; i++) w[s][i] *= size;
    }
}

void ancf_lever_couples(double first[3], double second[3], const ancf_table* t, const ancf_contact* c,
                        const double impulse[3]) {
    double w[2][3], moment[3];
    ancf_cross(moment, c->start, impulse);
    couples(w, t, c, moment);
    memcpy(first, w[0], sizeof w[0]);
    memcpy(second, w[1], sizeof w[1]);
}

void ancf_lever_kick(ancf_table* t, const ancf_contact* c, const double impulse[3], double step) {
    double w[2][3];
    ancf_lever_couples(w[0], w[1], t, c, impulse);
    for (int s = 0; s < 2; ++s) ancf_table_kick_slope(t, c->side[s].place, w[s], step);
}

void ancf_lever_slip(double v[3], const ancf_table* t, const ancf_contact* c) {
    double sum[3] = {0.0, 0.0, 0.0}, turning[3], more[3];
    for (int s = 0; s < 2; ++s) {
        const ancf_place* p = &t->place[c->side[s].place];
        const double size = c->radius[s] / ancf_dot(p->slope, p->slope);
        ancf_cross(turning, p->slope, p->bending);
        for (int i = 0; i < 3; i++) sum[i] += size * turning[i];
    }
    ancf_multiply(turning, c->lever, sum);
    ancf_cross(more, c->start, turning);
    for (int i = 0; i < 3; i++) v[i] += more[i];
}

// What is missing of a moment if couples balance it.
static void add_left(ancf_table* t, const ancf_contact* c, const double moment[3]) {
    for (int i = 0; i < 3; i++) t->left[i] += moment[i];
    if (!ancf_lever_has(c)) return;
    double w[2][3], twist[3];
    couples(w, t, c, moment);
    for (int s = 0; s < 2; ++s) {
        ancf_cross(twist, t->place[c->side[s].place].slope, w[s]);
        for (int i = 0; i < 3; i++) t->left[i] += twist[i];
    }
}

// Balances what friction has added to the moment of the normal impulses, but for what couples have balanced. Returns
// the square of that, *all is the square of the moment.
static double balance(ancf_table* t, ancf_contact* c, double step, double* all) {
    double moment[3], more[3], w[2][3];
    ancf_table_going(more, t, c);
    for (int i = 0; i < 3; i++) more[i] -= c->going[i];
    ancf_cross(moment, more, c->late);
    for (int i = 0; i < 3; i++) {
        more[i] = moment[i] - c->balanced[i];
        c->balanced[i] = moment[i];
    }
    *all = ancf_dot(moment, moment);
    if (!ancf_lever_has(c)) return 0.0;
    couples(w, t, c, more);
    for (int s = 0; s < 2; ++s) ancf_table_kick_slope(t, c->side[s].place, w[s], step);
    return ancf_dot(more, more);
}

void ancf_lever_balance(ancf_table* t, double step) {
    double change = 1.0, most = 0.0;
    for (int pass = 0; pass < PASSES && change > rounding * rounding * most; ++pass) {
        change = most = 0.0;
        for (int k = 0; k < t->groups.contacts; ++k) {
            ancf_contact* c = &t->contact[t->groups.list[ANCF_CONTACTS][k]];
            double all;
            if (!(c->radius[0] > 0.0) || !(c->impulse > 0.0)) continue;
            change = fmax(change, balance(t, c, step, &all));
            most = fmax(most, all);
        }
    }
    for (int k = 0; k < t->groups.contacts; ++k) {
        const ancf_contact* c = &t->contact[t->groups.list[ANCF_CONTACTS][k]];
        if (!(c->radius[0] > 0.0) || !(c->impulse > 0.0)) continue;
        double moment[3];
        ancf_cross(moment, c->start, c->friction);
        for (int i = 0; i < 3; i++) moment[i] = step * moment[i] + c->balanced[i];
        add_left(t, c, moment);
    }
}
