/* page_image.h: the part of an image around a box, as 8-bit voxels, fewer where it is large.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_IMAGE_H
#define PAGE_IMAGE_H

#include "html/page_bytes.h"
#include "smr.h"

typedef struct host_page_image {
    uint32_t size[3];
    float spacing[3];  /* mm; means over voxels of the image where it is larger than the image's */
    float first[3];    /* mm, centre of the first voxel */
    double low, high;  /* brightness that 0 and 255 stand for */
    unsigned char *at; /* [size[2]][size[1]][size[0]]; owned */
} host_page_image;

/* Cuts out what lies within margin_mm of the box, in at most so many voxels. 0, or -1 when out of memory. Where box
 * and image do not meet it is empty: at is NULL. */
int host_page_image_make(const smr_volume *image, const host_page_box *box, float margin_mm, size_t most,
                         host_page_image *out);

#endif
