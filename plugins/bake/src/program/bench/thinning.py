"""Thins bitmaps with OpenCV, and times it and scikit-image, one thread each.

    python thinning.py BITMAPS RESULT [--timed N]

BITMAPS: for each bitmap its width and height (u32, little endian) and a byte a pixel, 0 or 255. RESULT: the same of the
skeletons that OpenCV's ximgproc.thinning (Zhang and Suen) makes. The first N are timed; the seconds are printed as JSON,
the best of three runs.
"""

import json
import struct
import sys
import time

import cv2
import numpy
from skimage.morphology import skeletonize

cv2.setNumThreads(1)


def best(run, times=3):
    seconds = []
    for _ in range(times):
        began = time.perf_counter()
        result = run()
        seconds.append(time.perf_counter() - began)
    return min(seconds), result


def main():
    bitmaps, result = sys.argv[1], sys.argv[2]
    timed = int(sys.argv[4]) if len(sys.argv) > 4 else 0
    figures = []
    with open(bitmaps, "rb") as source, open(result, "wb") as target:
        while header := source.read(8):
            width, height = struct.unpack("<II", header)
            bitmap = numpy.frombuffer(source.read(width * height), numpy.uint8).reshape(height, width)
            thin = lambda: cv2.ximgproc.thinning(bitmap, thinningType=cv2.ximgproc.THINNING_ZHANGSUEN)
            if len(figures) < timed:
                opencv, skeleton = best(thin)
                scikit, _ = best(lambda: skeletonize(bitmap > 0))
                figures.append({"opencv": opencv, "scikit": scikit})
            else:
                skeleton = thin()
            target.write(header)
            target.write(skeleton.tobytes())
    print(json.dumps(figures))


main()
