// Friction of all contacts together, against closed forms and solves written here.
#include "check.h"

#include "ancf/contact.h"
#include <string.h>

enum { NODES = 2, DOFS = 4, STRIDE = 8 };

// One element of 1 m along x, built by hand: what the solver needs of a model, and no more.
typedef struct {
    ancf_element element;
    int ends[2];
    double x[3 * STRIDE], v[3 * STRIDE];
    ancf_model model;
} toy;

static void toy_make(toy* t) {
    memset(t, 0, sizeof *t);
    t->element = (ancf_element) {.kind = ANCF_LUMPED, .length = 1.0, .ea = 1.0, .rho_a = 1.0};
    t->ends[1] = 1;
    t->model = (ancf_model) {.n_nodes = NODES,
                             .n_elements = 1,
                             .n_dof = DOFS,
                             .stride = STRIDE,
                             .element = &t->element,
                             .ends = t->ends,
                             .x = t->x,
                             .v = t->v};
    t->x[1] = t->x[2] = t->x[3] = 1.0; // second node at (1, 0, 0), both slopes (1, 0, 0)
}

// A point on the element whose unknowns answer with an inverse mass matrix B (4 x 4).
typedef struct {
    int dof[DOFS];
    double dv[DOFS];
    ancf_point point;
} toy_point;

static void shape(double S[4], double xi) // Eq. 3-4 with l0 = 1
{
    S[0] = 1.0 - 3.0 * xi * xi + 2.0 * xi * xi * xi;
    S[1] = xi - 2.0 * xi * xi + xi * xi * xi;
    S[2] = 3.0 * xi * xi - 2.0 * xi * xi * xi;
    S[3] = xi * xi * xi - xi * xi;
}

static void toy_point_make(toy_point* p, double xi, double B[4][4]) {
    static const int place[4] = {0, 2, 1, 3}; // nodes first, then start slopes, then end slopes
    double S[4];
    shape(S, xi);
    p->point = (ancf_point) {.element = 0, .xi = xi, .n = DOFS, .dof = p->dof, .dv = p->dv};
    shape(p->point.S, xi);
    for (int i = 0; i < 4; ++i) {
        p->point.place[i] = place[i];
        p->dof[i] = place[i];
        p->dv[i] = 0.0;
        for (int j = 0; j < 4; ++j) p->dv[i] += B[i][j] * S[j];
        p->point.compliance += S[i] * p->dv[i];
    }
}

static void field_at(double u[3], const double* field, double xi) {
    double S[4];
    shape(S, xi);
    for (int c = 0; c < 3; ++c)
        u[c] = S[0] * field[c * STRIDE] + S[1] * field[c * STRIDE + 2] + S[2] * field[c * STRIDE + 1] +
               S[3] * field[c * STRIDE + 3];
}

static void diagonal(double B[4][4], double b0, double b1, double b2, double b3) {
    const double b[4] = {b0, b1, b2, b3};
    memset(B, 0, 16 * sizeof(double));
    for (int i = 0; i < 4; ++i) B[i][i] = b[i];
}

// B = A A^T + a little: symmetric and positive, dense.
static void random_matrix(double B[4][4], uint64_t* seed, double scale) {
    double A[4][4];
    for (int i = 0; i < 16; ++i) A[i / 4][i % 4] = random_between(seed, -1.0, 1.0);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            B[i][j] = i == j ? 0.1 * scale : 0.0;
            for (int k = 0; k < 4; ++k) B[i][j] += scale * A[i][k] * A[j][k];
        }
}

static double norm(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(double c[3], const double a[3], const double b[3]) {
    for (int i = 0; i < 3; ++i) c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void random_direction(double n[3], uint64_t* seed) {
    double length;
    do {
        for (int i = 0; i < 3; ++i) n[i] = random_between(seed, -1.0, 1.0);
        length = norm(n);
    } while (length < 0.1 || length > 1.0);
    for (int i = 0; i < 3; ++i) n[i] /= length;
}

static void random_velocity(double* v, uint64_t* seed, double scale) {
    memset(v, 0, 3 * STRIDE * sizeof *v);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < DOFS; ++i) v[c * STRIDE + i] = random_between(seed, -scale, scale);
}

// Hollars' formula, Eq. 11.
static double mu(const ancf_friction* law, double speed) {
    const double s = speed / law->v0;
    return fmin(s, 1.0) * (law->mu_k + 2.0 * (law->mu_s - law->mu_k) / (1.0 + s * s));
}

static const ancf_friction hollars = {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-3};
static const ancf_friction constant = {ANCF_FRICTION_HOLLARS, 0.3, 0.3, 1e-3};

// A contact point of a net, pulled along the surface: mu(u) f_n = T gives 2.5786e-4 m/s, and explicit friction 0.045.
static void held_point_creeps_at_closed_form(void** state) {
    (void)state;
    const double mass = 2.3e-5, normal_force = 0.5, pull = 0.05, v0 = 1e-3, dt = 2e-5;
    double low = 0.0, high = v0; // mu = 0.1 on the rising branch
    for (int i = 0; i < 100; ++i) {
        const double s = 0.5 * (low + high);
        if (mu(&hollars, s) * normal_force < pull) low = s;
        else high = s;
    }
    assert_near(low, 2.58e-4, 1e-6); // measured by the prototype, NUMERICS
    toy t;
    toy_point p;
    double B[4][4];
    toy_make(&t);
    diagonal(B, 1.0 / mass, 0.0, 0.0, 0.0);
    toy_point_make(&p, 0.0, B);
    ancf_contact c = {.point = &p.point, .normal = {0.0, 0.0, 1.0}, .normal_force = normal_force, .law = &hollars};
    for (int i = 0; i < 3000; ++i) {
        t.v[0] += 0.6 * dt * pull / mass;
        t.v[STRIDE] += 0.8 * dt * pull / mass;
        const int sweeps = ancf_contact_solve(&t.model, &c, 1, dt, t.v);
        assert_true(sweeps <= 3);
        const double speed = hypot(t.v[0], t.v[STRIDE]);
        assert_true(speed < 1.0001 * low); // never faster on the way
    }
    assert_close(hypot(t.v[0], t.v[STRIDE]), low, 1e-10);
    assert_close(t.v[0], 0.6 * low, 1e-10);
    assert_near(c.friction[0], -0.6 * pull, 1e-12);
    assert_near(c.friction[1], -0.8 * pull, 1e-12);
}

static void block_slides_to_rest(void** state) {
    (void)state;
    const double g = 9.81, speed = 1.0, dt = 1e-5, expected = speed * speed / (2.0 * 0.3 * g);
    const ancf_friction law = {ANCF_FRICTION_COULOMB, 0.0, 0.3, 1e-5};
    toy t;
    toy_point p;
    double B[4][4], way = 0.0;
    toy_make(&t);
    diagonal(B, 1.0 / 7.0, 0.0, 0.0, 0.0);
    toy_point_make(&p, 0.0, B);
    ancf_contact c = {.point = &p.point, .normal = {0.0, 1.0, 0.0}, .normal_force = 7.0 * g, .law = &law};
    t.v[0] = speed;
    for (int i = 0; i < 60000; ++i) {
        ancf_contact_solve(&t.model, &c, 1, dt, t.v);
        way += dt * t.v[0];
        assert_true(t.v[0] >= 0.0);
    }
    assert_close(way, expected, 1e-4);
    assert_near(t.v[0], 0.0, 1e-12);
}

// On a slope with tan(angle) = 0.5 and mu = 0.3 the acceleration is g (sin - 0.3 cos).
static void block_slides_down_a_slope(void** state) {
    (void)state;
    const double g = 9.81, angle = atan(0.5), dt = 1e-4, mass = 3.0;
    const ancf_friction law = {ANCF_FRICTION_COULOMB, 0.0, 0.3, 1e-6};
    toy t;
    toy_point p;
    double B[4][4];
    toy_make(&t);
    diagonal(B, 1.0 / mass, 0.0, 0.0, 0.0);
    toy_point_make(&p, 0.0, B);
    ancf_contact c = {.point = &p.point, .normal = {0.0, 0.0, 1.0}, .normal_force = mass * g * cos(angle), .law = &law};
    for (int i = 0; i < 10000; ++i) {
        t.v[0] += dt * g * sin(angle);
        ancf_contact_solve(&t.model, &c, 1, dt, t.v);
    }
    assert_close(t.v[0], g * (sin(angle) - 0.3 * cos(angle)), 1e-6);
}

// A sphere on a fixed axle, rubbed at its equator: w falls by mu f_n R/I each second.
static void sphere_spins_down(void** state) {
    (void)state;
    const double R = 0.1, inertia = 2e-3, normal_force = 4.0, spin = 20.0, dt = 1e-4;
    const ancf_friction law = {ANCF_FRICTION_COULOMB, 0.0, 0.25, 1e-6};
    for (int free_axes = 1; free_axes <= 3; free_axes += 2) { // a sheave turns about its axle alone
        toy t;
        toy_make(&t);
        const ancf_point held = {.place = {0, 2, 1, 3}, .S = {1.0}};
        ancf_partner sphere = {.position = {-R, 0.0, 0.0}, .spin = {0.0, 0.0, spin}};
        for (int i = 3 - free_axes; i < 3; ++i) sphere.inv_inertia[4 * i] = 1.0 / inertia;
        ancf_contact c = {
            .point = &held, .partner = &sphere, .normal = {1.0, 0.0, 0.0}, .normal_force = normal_force, .law = &law};
        const double rate = 0.25 * normal_force * R / inertia;
        for (int i = 0; i < 2000; ++i) ancf_contact_solve(&t.model, &c, 1, dt, t.v);
        assert_close(sphere.spin[2], spin - 0.2 * rate, 1e-9);
        assert_close(c.friction[1], 0.25 * normal_force, 1e-12);
        for (int i = 0; i < 10000; ++i) ancf_contact_solve(&t.model, &c, 1, dt, t.v);
        assert_near(sphere.spin[2], 0.0, 1e-9);
    }
}

static void no_normal_force_no_friction(void** state) {
    (void)state;
    uint64_t seed = 3;
    toy t;
    toy_point p;
    double B[4][4], before[3 * STRIDE];
    toy_make(&t);
    random_matrix(B, &seed, 10.0);
    toy_point_make(&p, 0.3, B);
    random_velocity(t.v, &seed, 1.0);
    memcpy(before, t.v, sizeof before);
    const ancf_friction none = {ANCF_FRICTION_NONE, 0.3, 0.2, 1e-3};
    ancf_contact c[2] = {
        {.point = &p.point, .normal = {0.0, 0.0, 1.0}, .law = &hollars, .friction = {1.0, 2.0, 3.0}},
        {.point = &p.point, .normal = {0.0, 1.0, 0.0}, .normal_force = 5.0, .law = &none, .friction = {1.0, 2.0, 3.0}}};
    ancf_contact_solve(&t.model, c, 2, 1e-3, t.v);
    for (int k = 0; k < 2; ++k)
        for (int i = 0; i < 3; ++i) assert_true(c[k].friction[i] == 0.0);
    assert_memory_equal(before, t.v, sizeof before);
    assert_int_equal(ancf_contact_solve(&t.model, NULL, 0, 1e-3, t.v) >= 0, 1);
}

// A scene of up to four contacts: points on the cable, two free bodies, one contact of the cable with itself.
typedef struct {
    toy t;
    toy_point point[5];
    ancf_partner body[2];
    ancf_contact c[4];
    int n;
} scene;

static void scene_make(scene* s, uint64_t* seed, const ancf_friction* law, int n, double slip) {
    double B[4][4];
    memset(s, 0, sizeof *s);
    toy_make(&s->t);
    random_matrix(B, seed, 30.0);
    random_velocity(s->t.v, seed, slip);
    for (int k = 0; k < 5; ++k) toy_point_make(&s->point[k], random_unit(seed), B);
    for (int b = 0; b < 2; ++b) {
        ancf_partner* body = &s->body[b];
        double A[9];
        for (int i = 0; i < 9; ++i) A[i] = random_between(seed, -1.0, 1.0);
        for (int i = 0; i < 3; ++i) {
            body->position[i] = random_between(seed, -0.3, 0.3);
            body->velocity[i] = random_between(seed, -slip, slip);
            body->spin[i] = random_between(seed, -slip, slip);
            body->inv_mass[i] = 5.0;
            for (int j = 0; j < 3; ++j)
                body->inv_inertia[3 * i + j] = 40.0 * (A[3 * i] * A[3 * j] + A[3 * i + 1] * A[3 * j + 1] +
                                                       A[3 * i + 2] * A[3 * j + 2] + (i == j ? 0.2 : 0.0));
        }
    }
    s->n = n;
    for (int k = 0; k < n; ++k) {
        s->c[k] =
            (ancf_contact) {.point = &s->point[k].point, .normal_force = random_between(seed, 0.1, 3.0), .law = law};
        if (k == 3) s->c[k].other = &s->point[4].point;
        else if (k > 0) s->c[k].partner = &s->body[k - 1];
        random_direction(s->c[k].normal, seed);
    }
}

static void relative_velocity(double u[3], const scene* s, const ancf_contact* c, const double* v,
                              const ancf_partner* body) {
    double w[3] = {0.0, 0.0, 0.0};
    field_at(u, v, c->point->xi);
    if (c->other) field_at(w, v, c->other->xi);
    if (c->partner) {
        const ancf_partner* b = body + (c->partner - s->body);
        double arm[3];
        field_at(arm, s->t.x, c->point->xi);
        for (int i = 0; i < 3; ++i) arm[i] -= b->position[i];
        cross(w, b->spin, arm);
        for (int i = 0; i < 3; ++i) w[i] += b->velocity[i];
    }
    for (int i = 0; i < 3; ++i) u[i] -= w[i];
    const double along = dot(u, c->normal);
    for (int i = 0; i < 3; ++i) u[i] -= along * c->normal[i];
}

// State after the forces f (n x 3) have acted for dt on what was there before: written out, not taken from the solver.
static void apply(double* v, ancf_partner body[2], const scene* before, double f[][3], double dt) {
    memcpy(v, before->t.v, sizeof before->t.v);
    memcpy(body, before->body, sizeof before->body);
    for (int k = 0; k < before->n; ++k) {
        const ancf_contact* c = &before->c[k];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < DOFS; ++j) {
                v[i * STRIDE + c->point->dof[j]] += dt * c->point->dv[j] * f[k][i];
                if (c->other) v[i * STRIDE + c->other->dof[j]] -= dt * c->other->dv[j] * f[k][i];
            }
        if (!c->partner) continue;
        ancf_partner* b = body + (c->partner - before->body);
        double arm[3], moment[3];
        field_at(arm, before->t.x, c->point->xi);
        for (int i = 0; i < 3; ++i) arm[i] -= b->position[i];
        cross(moment, arm, f[k]);
        for (int i = 0; i < 3; ++i) {
            b->velocity[i] -= dt * b->inv_mass[i] * f[k][i];
            b->spin[i] -= dt * dot(b->inv_inertia + 3 * i, moment);
        }
    }
}

// The equations themselves: friction is -mu(|u|) f_n u/|u| of the velocity u that it leaves.
static double residual(const scene* before, double f[][3], double dt) {
    double v[3 * STRIDE], worst = 0.0;
    ancf_partner body[2];
    apply(v, body, before, f, dt);
    for (int k = 0; k < before->n; ++k) {
        const ancf_contact* c = &before->c[k];
        double u[3];
        relative_velocity(u, before, c, v, body);
        const double speed = norm(u), force = mu(c->law, speed) * c->normal_force;
        for (int i = 0; i < 3; ++i) worst = fmax(worst, fabs(f[k][i] + (speed > 0.0 ? force * u[i] / speed : 0.0)));
    }
    return worst;
}

static void solve_copy(scene* after, const scene* before, double dt, double guess, uint64_t* seed, int* sweeps) {
    *after = *before;
    for (int k = 0; k < after->n; ++k) {
        after->c[k].point = &after->point[k].point;
        if (after->c[k].other) after->c[k].other = &after->point[4].point;
        if (after->c[k].partner) after->c[k].partner = after->body + (before->c[k].partner - before->body);
        for (int i = 0; i < 3; ++i) after->c[k].friction[i] = random_between(seed, -guess, guess);
    }
    // As in a run of steps: the result is the next guess, until one call is enough.
    *sweeps = ancf_contact_solve(&after->t.model, after->c, after->n, dt, after->t.v);
    for (int i = 0; i < 10 && *sweeps > 2; ++i) {
        memcpy(after->t.v, before->t.v, sizeof after->t.v);
        memcpy(after->body, before->body, sizeof after->body);
        *sweeps = ancf_contact_solve(&after->t.model, after->c, after->n, dt, after->t.v);
    }
}

static void many_contacts_solve_their_equations(void** state) {
    (void)state;
    uint64_t seed = 4;
    int converged = 0, runs = 0;
    for (int run = 0; run < 600; ++run) {
        const double dt = random_magnitude(&seed, 1e-6, 1e-3), slip = random_magnitude(&seed, 1e-4, 1.0);
        scene before, after;
        double f[4][3];
        int sweeps;
        scene_make(&before, &seed, run % 2 ? &hollars : &constant, 1 + run % 4, slip);
        before.t.model.element = &before.t.element;
        solve_copy(&after, &before, dt, run % 3 ? 0.5 : 0.0, &seed, &sweeps);
        for (int k = 0; k < before.n; ++k) memcpy(f[k], after.c[k].friction, sizeof f[k]);
        runs++;
        if (sweeps <= 2) {
            converged++;
            assert_near(residual(&before, f, dt), 0.0, 3e-7);
        }
        for (int k = 0; k < before.n; ++k) {
            assert_near(dot(f[k], before.c[k].normal), 0.0, 1e-14);
            assert_true(norm(f[k]) <= 0.3 * before.c[k].normal_force * (1.0 + 1e-14));
        }
        // What the solver says it did to the velocities is what these forces do, and nothing else.
        double v[3 * STRIDE];
        ancf_partner body[2];
        apply(v, body, &before, f, dt);
        for (int i = 0; i < 3 * STRIDE; ++i) assert_near(after.t.v[i], v[i], 1e-12);
        for (int b = 0; b < 2; ++b)
            for (int i = 0; i < 3; ++i) {
                assert_near(after.body[b].velocity[i], body[b].velocity[i], 1e-12);
                assert_near(after.body[b].spin[i], body[b].spin[i], 1e-12);
            }
    }
    print_message("converged %d of %d\n", converged, runs);
    assert_true(converged > runs * 95 / 100);
}

// Solves A x = b (n x n), partial pivoting.
static void dense_solve(double* x, double* A, double* b, int n) {
    for (int j = 0; j < n; ++j) {
        int best = j;
        for (int i = j + 1; i < n; ++i)
            if (fabs(A[i * n + j]) > fabs(A[best * n + j])) best = i;
        for (int k = 0; k < n; ++k) {
            const double swap = A[j * n + k];
            A[j * n + k] = A[best * n + k];
            A[best * n + k] = swap;
        }
        const double swap = b[j];
        b[j] = b[best];
        b[best] = swap;
        for (int i = j + 1; i < n; ++i) {
            const double factor = A[i * n + j] / A[j * n + j];
            for (int k = j; k < n; ++k) A[i * n + k] -= factor * A[j * n + k];
            b[i] -= factor * b[j];
        }
    }
    for (int i = n - 1; i >= 0; --i) {
        x[i] = b[i];
        for (int k = i + 1; k < n; ++k) x[i] -= A[i * n + k] * x[k];
        x[i] /= A[i * n + i];
    }
}

// Two masses in two directions, coupled by an inverse mass matrix, by Newton's method on the four velocities with
// growing time: constant mu, so that there is one solution.
static void newton_two(double u[4], double free[4], double b11, double b12, double b22, double f1, double f2,
                       double dt) {
    const double B[2][2] = {{b11, b12}, {b12, b22}}, fn[2] = {f1, f2}, mu0 = 0.3, v0 = 1e-3;
    memcpy(u, free, 4 * sizeof *u);
    for (int level = 1; level <= 2000; ++level) { // continuation in dt keeps Newton near the solution
        const double h = dt * level / 2000.0;
        for (int it = 0; it < 50; ++it) {
            double r[4], J[16] = {0.0}, d[4], D[2][2][2], force[2][2], size = 0.0;
            for (int k = 0; k < 2; ++k) {
                const double s = hypot(u[2 * k], u[2 * k + 1]);
                for (int i = 0; i < 2; ++i) {
                    const double w = s < v0 ? mu0 * fn[k] / v0 : mu0 * fn[k] / s;
                    force[k][i] = -w * u[2 * k + i];
                    for (int j = 0; j < 2; ++j)
                        D[k][i][j] = -w * (i == j) + (s < v0 ? 0.0 : w * u[2 * k + i] * u[2 * k + j] / (s * s));
                }
            }
            for (int k = 0; k < 2; ++k)
                for (int i = 0; i < 2; ++i) {
                    r[2 * k + i] = -(u[2 * k + i] - free[2 * k + i]);
                    J[(2 * k + i) * 4 + 2 * k + i] = 1.0;
                    for (int l = 0; l < 2; ++l) {
                        r[2 * k + i] += h * B[k][l] * force[l][i];
                        for (int j = 0; j < 2; ++j) J[(2 * k + i) * 4 + 2 * l + j] -= h * B[k][l] * D[l][i][j];
                    }
                }
            dense_solve(d, J, r, 4);
            for (int i = 0; i < 4; ++i) {
                u[i] += d[i];
                size = fmax(size, fabs(d[i]));
            }
            if (size < 1e-16) break;
        }
    }
}

static void two_masses_against_newton(void** state) {
    (void)state;
    uint64_t seed = 5;
    int stuck = 0, sliding = 0;
    for (int run = 0; run < 60; ++run) {
        const double b11 = random_between(&seed, 20.0, 60.0), b22 = random_between(&seed, 20.0, 60.0);
        const double b12 = random_between(&seed, -0.8, 0.8) * sqrt(b11 * b22), dt = random_magnitude(&seed, 1e-5, 1e-3);
        double B[4][4], free[4], u[4];
        toy t;
        toy_point p[2];
        toy_make(&t);
        diagonal(B, b11, 0.0, b22, 0.0);
        B[0][2] = B[2][0] = b12;
        toy_point_make(&p[0], 0.0, B);
        toy_point_make(&p[1], 1.0, B);
        ancf_contact c[2];
        for (int k = 0; k < 2; ++k) {
            c[k] = (ancf_contact) {.point = &p[k].point,
                                   .normal = {0.0, 0.0, 1.0},
                                   .normal_force = random_between(&seed, 0.1, 2.0),
                                   .law = &constant};
            for (int i = 0; i < 2; ++i)
                free[2 * k + i] = t.v[i * STRIDE + k] = random_between(&seed, -1.0, 1.0) * (run % 2 ? 0.02 : 2e-3);
        }
        newton_two(u, free, b11, b12, b22, c[0].normal_force, c[1].normal_force, dt);
        int sweeps = 3;
        for (int i = 0; i < 20 && sweeps > 2; ++i) { // the result is the next guess
            for (int k = 0; k < 4; ++k) t.v[k % 2 * STRIDE + k / 2] = free[k];
            sweeps = ancf_contact_solve(&t.model, c, 2, dt, t.v);
        }
        assert_true(sweeps <= 2);
        for (int k = 0; k < 2; ++k) {
            if (hypot(u[2 * k], u[2 * k + 1]) < 1e-3) stuck++;
            else sliding++;
            for (int i = 0; i < 2; ++i) assert_near(t.v[i * STRIDE + k], u[2 * k + i], 1e-9);
        }
    }
    assert_true(stuck > 10 && sliding > 10);
}

// A node of mass a and free bodies: what one gains the others lose, and so with the moments about the origin.
static void momentum_is_exchanged(void** state) {
    (void)state;
    uint64_t seed = 6;
    const double a[2] = {0.5, 0.2}, mass[2] = {2.0, 0.3}, inertia[2] = {0.02, 0.1};
    for (int run = 0; run < 100; ++run) {
        toy t;
        toy_point p[2];
        double B[4][4];
        toy_make(&t);
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < DOFS; ++i) t.x[c * STRIDE + i] = random_between(&seed, -1.0, 1.0);
        diagonal(B, 1.0 / a[0], 0.0, 1.0 / a[1], 0.0);
        toy_point_make(&p[0], 0.0, B);
        toy_point_make(&p[1], 1.0, B);
        random_velocity(t.v, &seed, 0.1);
        ancf_partner body[2] = {0};
        ancf_contact c[4];
        for (int b = 0; b < 2; ++b)
            for (int i = 0; i < 3; ++i) {
                body[b].position[i] = random_between(&seed, -1.0, 1.0);
                body[b].velocity[i] = random_between(&seed, -0.1, 0.1);
                body[b].spin[i] = random_between(&seed, -0.1, 0.1);
                body[b].inv_mass[i] = 1.0 / mass[b];
                body[b].inv_inertia[4 * i] = 1.0 / inertia[b];
            }
        double before[6], after[6], terms = 0.0;
        for (int k = 0; k < 4; ++k) {
            c[k] = (ancf_contact) {.point = &p[k % 2].point,
                                   .partner = &body[k / 2],
                                   .normal_force = random_between(&seed, 0.1, 30.0),
                                   .law = &hollars};
            random_direction(c[k].normal, &seed);
            for (int i = 0; i < 3; ++i) c[k].friction[i] = random_between(&seed, -1.0, 1.0);
        }
        for (int pass = 0; pass < 2; ++pass) {
            double* sum = pass ? after : before;
            if (pass) ancf_contact_solve(&t.model, c, 4, 1e-3, t.v);
            for (int i = 0; i < 6; ++i) sum[i] = 0.0;
            for (int k = 0; k < 2; ++k) {
                const double x[3] = {t.x[k], t.x[STRIDE + k], t.x[2 * STRIDE + k]};
                const double v[3] = {t.v[k], t.v[STRIDE + k], t.v[2 * STRIDE + k]};
                double l[3], lb[3];
                cross(l, x, v);
                cross(lb, body[k].position, body[k].velocity);
                for (int i = 0; i < 3; ++i) {
                    sum[i] += a[k] * v[i] + mass[k] * body[k].velocity[i];
                    sum[3 + i] += a[k] * l[i] + mass[k] * lb[i] + inertia[k] * body[k].spin[i];
                    terms +=
                        fabs(a[k] * v[i]) + fabs(mass[k] * body[k].velocity[i]) + fabs(inertia[k] * body[k].spin[i]);
                }
            }
        }
        for (int i = 0; i < 6; ++i) assert_near(after[i], before[i], 1e-14 * terms);
    }
}

// Friction takes energy out, never puts it in.
static void friction_dissipates(void** state) {
    (void)state;
    uint64_t seed = 7;
    for (int run = 0; run < 200; ++run) {
        scene before, after;
        int sweeps;
        scene_make(&before, &seed, &hollars, 4, 0.3);
        solve_copy(&after, &before, 1e-4, 0.0, &seed, &sweeps);
        for (int k = 0; k < 4; ++k) {
            double u[3];
            relative_velocity(u, &after, &after.c[k], after.t.v, after.body);
            assert_true(dot(u, after.c[k].friction) <= 1e-10);
        }
    }
}

static void same_table_same_bits(void** state) {
    (void)state;
    uint64_t seed = 8;
    scene before, one, two;
    int sweeps, again;
    scene_make(&before, &seed, &hollars, 4, 0.3);
    uint64_t guess = 9;
    solve_copy(&one, &before, 1e-4, 0.1, &guess, &sweeps);
    guess = 9;
    solve_copy(&two, &before, 1e-4, 0.1, &guess, &again);
    assert_int_equal(sweeps, again);
    assert_memory_equal(one.t.v, two.t.v, sizeof one.t.v);
    for (int k = 0; k < 4; ++k) assert_memory_equal(one.c[k].friction, two.c[k].friction, sizeof one.c[k].friction);
}

// The result as first guess of the same problem changes nothing and takes one sweep.
static void solution_is_a_good_guess(void** state) {
    (void)state;
    uint64_t seed = 10;
    scene before, one;
    int sweeps;
    scene_make(&before, &seed, &constant, 4, 0.3);
    solve_copy(&one, &before, 1e-4, 0.0, &seed, &sweeps);
    memcpy(one.t.v, before.t.v, sizeof one.t.v);
    memcpy(one.body, before.body, sizeof one.body);
    assert_true(ancf_contact_solve(&one.t.model, one.c, 4, 1e-4, one.t.v) <= 2);
}

// A surface that moves under the point drags it along: v tends to the surface's velocity at the centreline.
static void spinning_body_drags_the_point(void** state) {
    (void)state;
    toy t;
    toy_point p;
    double B[4][4];
    toy_make(&t);
    diagonal(B, 1.0 / 0.01, 0.0, 0.0, 0.0);
    toy_point_make(&p, 0.0, B);
    ancf_partner drum = {.position = {0.0, 0.0, -0.3}, .spin = {0.0, 2.0, 0.0}, .velocity = {0.1, 0.0, 0.0}};
    ancf_contact c = {
        .point = &p.point, .partner = &drum, .normal = {0.0, 0.0, 1.0}, .normal_force = 1.0, .law = &hollars};
    for (int i = 0; i < 3000; ++i) ancf_contact_solve(&t.model, &c, 1, 1e-4, t.v);
    assert_near(t.v[0], 0.1 + 2.0 * 0.3, 1e-9); // (0,2,0) x (0,0,0.3) = (0.6,0,0)
    assert_true(drum.spin[1] == 2.0 && drum.velocity[0] == 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(held_point_creeps_at_closed_form),
        cmocka_unit_test(block_slides_to_rest),
        cmocka_unit_test(block_slides_down_a_slope),
        cmocka_unit_test(sphere_spins_down),
        cmocka_unit_test(no_normal_force_no_friction),
        cmocka_unit_test(many_contacts_solve_their_equations),
        cmocka_unit_test(two_masses_against_newton),
        cmocka_unit_test(momentum_is_exchanged),
        cmocka_unit_test(friction_dissipates),
        cmocka_unit_test(same_table_same_bits),
        cmocka_unit_test(solution_is_a_good_guess),
        cmocka_unit_test(spinning_body_drags_the_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
