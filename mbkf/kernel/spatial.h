/* Spatial vectors at the world's origin in world axes (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 2).
 * Six numbers: linear, then angular velocity; force, then moment. */
#ifndef MBKF_SPATIAL_H
#define MBKF_SPATIAL_H

/* Inertia: mass, mass times centre of mass, and moments xx xy xz yy yz zz, all about the origin. */
typedef struct {
    double mass, first[3], second[6];
} Inertia;

static inline void cross(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double dot3(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double dot6(const double *a, const double *b) { return dot3(a, b) + dot3(a + 3, b + 3); }

/* Motion b as a motion m carries it along: m x b. */
static inline void cross_motion(const double *m, const double *b, double *c)
{
    double x[3], y[3];
    cross(m + 3, b, x);
    cross(m, b + 3, y);
    for (int i = 0; i < 3; i++)
        c[i] = x[i] + y[i];
    cross(m + 3, b + 3, c + 3);
}

/* Force f as a motion m carries it along: m x* f. */
static inline void cross_force(const double *m, const double *f, double *c)
{
    double x[3], y[3];
    cross(m + 3, f, c);
    cross(m + 3, f + 3, x);
    cross(m, f, y);
    for (int i = 0; i < 3; i++)
        c[3 + i] = x[i] + y[i];
}

/* Momentum f of a motion m, or force of an acceleration. */
static inline void momentum(const Inertia *inertia, const double *m, double *f)
{
    const double *h = inertia->first, *I = inertia->second, *w = m + 3;
    double x[3], y[3];
    cross(w, h, x);
    cross(h, m, y);
    for (int i = 0; i < 3; i++)
        f[i] = inertia->mass * m[i] + x[i];
    f[3] = y[0] + I[0] * w[0] + I[1] * w[1] + I[2] * w[2];
    f[4] = y[1] + I[1] * w[0] + I[3] * w[1] + I[4] * w[2];
    f[5] = y[2] + I[2] * w[0] + I[4] * w[1] + I[5] * w[2];
}

/* c = R b of a matrix whose columns stand one after the other, and R' b. */
static inline void rotated(const double *R, const double *b, double *c)
{
    for (int i = 0; i < 3; i++)
        c[i] = R[i] * b[0] + R[3 + i] * b[1] + R[6 + i] * b[2];
}

static inline void rotated_back(const double *R, const double *b, double *c)
{
    for (int i = 0; i < 3; i++)
        c[i] = dot3(R + 3 * i, b);
}

#endif
