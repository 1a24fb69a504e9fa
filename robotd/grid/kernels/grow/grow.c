/* Growing by a disk in two passes: along the columns the way to the nearest cell of the set in each, then along the rows
 * whether any column's is no longer than the disk is high there. Bytes throughout, so that compilers make vectors of it.
 */
#include "grow/grow.h"

#include <stddef.h>
#include <string.h>

#define FAR 255

/* ways = 0 in the set and FAR elsewhere, for the window and all within reach, on the grid or not. */
static void begin(const grow_job *job, int32_t height, int32_t width)
{
    const int32_t top = job->first_row - job->reach, left = job->first_col - job->reach;
    const int32_t first = left < 0 ? -left : 0, end = left + width > job->cols ? job->cols - left : width;
    memset(job->ways, job->outside ? 0 : FAR, (size_t)height * (size_t)width);
    for (int32_t i = 0; i < height; i++) {
        if (top + i < 0 || top + i >= job->rows)
            continue;
        const uint8_t *mask = job->mask + (ptrdiff_t)(top + i) * job->cols + left;
        uint8_t *ways = job->ways + (size_t)i * (size_t)width;
        for (int32_t k = first; k < end; k++)
            ways[k] = mask[k] ? 0 : FAR;
    }
}

/* What is nearer by way of the row before. */
static void pass_on(const uint8_t *restrict before, uint8_t *restrict ways, int32_t width)
{
    for (int32_t k = 0; k < width; k++) {
        const uint8_t farther = (uint8_t)(before[k] + (before[k] != FAR));
        ways[k] = farther < ways[k] ? farther : ways[k];
    }
}

static void along_row(const grow_job *job, const uint8_t *restrict ways, uint8_t *restrict grown)
{
    const int32_t width = job->end_col - job->first_col;
    memset(grown, 0, (size_t)width);
    for (int32_t column = 0; column <= 2 * job->reach; column++) {
        const uint8_t height = job->heights[column];
        for (int32_t k = 0; k < width; k++)
            grown[k] |= ways[k + column] <= height;
    }
}

void grow_disk(const grow_job *job)
{
    const int32_t height = job->end_row - job->first_row + 2 * job->reach;
    const int32_t width = job->end_col - job->first_col + 2 * job->reach;
    const size_t stride = (size_t)width;
    begin(job, height, width);
    for (int32_t i = 1; i < height; i++)
        pass_on(job->ways + (size_t)(i - 1) * stride, job->ways + (size_t)i * stride, width);
    for (int32_t i = height - 2; i >= 0; i--)
        pass_on(job->ways + (size_t)(i + 1) * stride, job->ways + (size_t)i * stride, width);
    for (int32_t row = job->first_row; row < job->end_row; row++)
        along_row(job, job->ways + (size_t)(row - job->first_row + job->reach) * stride,
                  job->grown + (size_t)row * (size_t)job->cols + (size_t)job->first_col);
}
