/* The five-state induction motor, classical Runge-Kutta, fixed step, voltages held: the same loop as the
 * Rust model, written as a C programmer would. A worker for the benchmark: it reads the case once, then
 * obeys one command after another, so that both languages are timed alternately in one run.
 *
 * Input (binary, native byte order):
 *   double r_s, r_r, l_ls, l_lr, l_m, n_p, inertia, friction, h; double n;
 *   n rows of double u_alpha, u_beta, tau_load
 * then commands: double passes.
 *   passes > 0: answers double elapsed_ns and the final state (6 doubles)
 *   passes = 0: answers n rows of double i_alpha, i_beta, omega_mech (before each step)
 */
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef struct {
    double r_s, r_r, inv_s, inv_r, inv_m;
    double n_p, friction, inv_inertia;
} motor;

typedef struct {
    double psi_s_a, psi_s_b, psi_r_a, psi_r_b, omega, theta;
} state;

typedef struct {
    double u_a, u_b, tau;
} held;

static inline state rate(const motor *m, const state *x, const held *u) {
    double i_s_a = x->psi_s_a * m->inv_s - x->psi_r_a * m->inv_m;
    double i_s_b = x->psi_s_b * m->inv_s - x->psi_r_b * m->inv_m;
    double i_r_a = x->psi_r_a * m->inv_r - x->psi_s_a * m->inv_m;
    double i_r_b = x->psi_r_b * m->inv_r - x->psi_s_b * m->inv_m;
    double tau_em = 1.5 * m->n_p * (x->psi_s_a * i_s_b - x->psi_s_b * i_s_a);
    double omega_el = m->n_p * x->omega;
    state d;
    d.psi_s_a = u->u_a - m->r_s * i_s_a;
    d.psi_s_b = u->u_b - m->r_s * i_s_b;
    d.psi_r_a = -m->r_r * i_r_a - omega_el * x->psi_r_b;
    d.psi_r_b = -m->r_r * i_r_b + omega_el * x->psi_r_a;
    d.omega = (tau_em - m->friction * x->omega - u->tau) * m->inv_inertia;
    d.theta = x->omega;
    return d;
}

static inline state advanced(const state *x, double h, const state *d) {
    state y;
    y.psi_s_a = x->psi_s_a + h * d->psi_s_a;
    y.psi_s_b = x->psi_s_b + h * d->psi_s_b;
    y.psi_r_a = x->psi_r_a + h * d->psi_r_a;
    y.psi_r_b = x->psi_r_b + h * d->psi_r_b;
    y.omega = x->omega + h * d->omega;
    y.theta = x->theta + h * d->theta;
    return y;
}

static inline void step(const motor *m, state *x, double h, const held *u) {
    state k1 = rate(m, x, u), at;
    at = advanced(x, 0.5 * h, &k1);
    state k2 = rate(m, &at, u);
    at = advanced(x, 0.5 * h, &k2);
    state k3 = rate(m, &at, u);
    at = advanced(x, h, &k3);
    state k4 = rate(m, &at, u);
    state sum = advanced(&k1, 2.0, &k2);
    sum = advanced(&sum, 2.0, &k3);
    sum = advanced(&sum, 1.0, &k4);
    *x = advanced(x, h / 6.0, &sum);
}

/* Not inlined: every pass starts from rest and must really be run. */
__attribute__((noinline)) static state run(const motor *m, double h, const held *rows, size_t n) {
    state x = {0};
    for (size_t k = 0; k < n; k++)
        step(m, &x, h, &rows[k]);
    return x;
}

static void trajectory(const motor *m, double h, const held *rows, size_t n) {
    state x = {0};
    for (size_t k = 0; k < n; k++) {
        double row[3] = {x.psi_s_a * m->inv_s - x.psi_r_a * m->inv_m,
                         x.psi_s_b * m->inv_s - x.psi_r_b * m->inv_m, x.omega};
        fwrite(row, sizeof row, 1, stdout);
        step(m, &x, h, &rows[k]);
    }
}

static void timed(const motor *m, double h, const held *rows, size_t n, double passes) {
    struct timespec from, to;
    volatile state kept;
    clock_gettime(CLOCK_MONOTONIC, &from);
    for (double pass = 0; pass < passes; pass++)
        kept = run(m, h, rows, n);
    clock_gettime(CLOCK_MONOTONIC, &to);
    double answer[7] = {1e9 * (double)(to.tv_sec - from.tv_sec) + (double)(to.tv_nsec - from.tv_nsec),
                        kept.psi_s_a, kept.psi_s_b, kept.psi_r_a, kept.psi_r_b, kept.omega, kept.theta};
    fwrite(answer, sizeof answer, 1, stdout);
}

int main(void) {
    double p[10];
    if (fread(p, sizeof p, 1, stdin) != 1)
        return 1;
    double l_s = p[2] + p[4], l_r = p[3] + p[4], det = p[2] * l_r + p[4] * p[3];
    motor m = {p[0], p[1], l_r / det, l_s / det, p[4] / det, p[5], p[7], 1.0 / p[6]};
    size_t n = (size_t)p[9];
    held *rows = malloc(n * sizeof *rows);
    if (!rows || fread(rows, sizeof *rows, n, stdin) != n)
        return 1;
    double passes;
    while (fread(&passes, sizeof passes, 1, stdin) == 1) {
        if (passes > 0)
            timed(&m, p[8], rows, n, passes);
        else
            trajectory(&m, p[8], rows, n);
        fflush(stdout);
    }
    free(rows);
    return 0;
}
