/* mbkf/sensors/contact/floor.py and mbkf/numerics/running_median.py on a memory of numbers. Behind the plates it holds,
 * each of the window's length: for x and y the latest velocities, and those that are not NaN in ascending order; then
 * the pelvis, x, y and z of each frame. */
#include "floor_motion.h"

#include <math.h>
#include <string.h>

static int window_at(const Feet *feet) { return HEAD + PER_PLATE * feet->plates; }

/* bisect_left */
static int rank_of(const double *ranked, int count, double value)
{
    int low = 0, high = count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (ranked[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Copies ordered numbers without an old one and with a new one, each of which may be NaN; returns the new count. */
static int update_ranks(const double *before, int count, double old, double value, double *ranked)
{
    memcpy(ranked, before, sizeof *ranked * count);
    if (!isnan(old)) {
        const int at = rank_of(ranked, count, old);
        if (at < count) {
            memmove(ranked + at, ranked + at + 1, sizeof *ranked * (--count - at));
            ranked[count] = 0.0;
        }
    }
    if (!isnan(value)) {
        const int at = rank_of(ranked, count, value);
        memmove(ranked + at + 1, ranked + at, sizeof *ranked * (count++ - at));
        ranked[at] = value;
    }
    return count;
}

/* Movement.with_frame */
void movement_add_frame(const Feet *feet, const double *before, const double *low, const double *pelvis, double *after)
{
    const int window = feet->window, at = window_at(feet), frames = (int)before[FRAMES], gone = frames == window;
    const int kept = frames - gone;
    for (int i = 0; i < 2; i++) {
        const int latest = at + 2 * i * window, ranked = latest + window;
        memcpy(after + latest, before + latest + gone, sizeof *after * kept);
        after[latest + kept] = low[i];
        after[RANKED + i] = update_ranks(before + ranked, (int)before[RANKED + i], gone ? before[latest] : NAN, low[i],
                                        after + ranked);
    }
    const int path = at + 4 * window;
    memcpy(after + path, before + path + 3 * gone, 3 * sizeof *after * kept);
    memcpy(after + path + 3 * kept, pelvis, 3 * sizeof *after);
    after[FRAMES] = kept + 1;
    after[AIRBORNE] = before[AIRBORNE];
}

/* RunningMedian.median */
static double median(const double *ranked, int count, int zeros)
{
    const int negative = rank_of(ranked, count, 0.0);
    double sum = 0.0;
    for (int half = 0; half < 2; half++) {
        const int rank = (count + zeros - 1 + half) / 2;
        sum += rank < negative ? ranked[rank] : rank < negative + zeros ? 0.0 : ranked[rank - zeros];
    }
    return 0.5 * sum;
}

/* Movement.floor_m_s */
void movement_velocity(const Feet *feet, const double *record, double *floor_m_s)
{
    const int window = feet->window, at = window_at(feet), frames = (int)record[FRAMES];
    double found[2], past[2];
    floor_m_s[0] = floor_m_s[1] = 0.0;
    for (int i = 0; i < 2; i++)
        found[i] = median(record + at + (2 * i + 1) * window, (int)record[RANKED + i], feet->still);
    const double speed = hypot(found[0], found[1]), lasted_s = frames * feet->dt_s;
    if (speed < feet->limits.belt_from_m_s)
        return;
    const double *first = record + at + 4 * window, *last = first + 3 * (frames - 1);
    for (int i = 0; i < 2; i++)
        past[i] = (last[i] - first[i]) / lasted_s - found[i];
    if (!(hypot(past[0], past[1]) < 0.5 * speed))
        memcpy(floor_m_s, found, sizeof found);
}

/* Movement.held_up: the curvature of heights is their product with a parabola orthogonal to straight lines. */
int movement_held_up(const Feet *feet, const double *record)
{
    const int n = feet->fall, frames = (int)record[FRAMES];
    double along = 0.0, square = 0.0;
    if (record[AIRBORNE] < n || frames < n)
        return 0;
    const double *height = record + window_at(feet) + 4 * feet->window + 3 * (frames - n) + 2;
    for (int i = 0; i < n; i++) {
        const double step = i - 0.5 * (n - 1), parabola = step * step - ((double)n * n - 1.0) / 12.0;
        along += parabola * height[3 * i];
        square += parabola * parabola;
    }
    return 2.0 * along / square / (feet->dt_s * feet->dt_s) > feet->limits.fall_m_s2;
}
