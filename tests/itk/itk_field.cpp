// itk_field.cpp: reads a displacement field with ITK, moves points by it and compares with where they should go.
// Usage: itk_field FIELD FROM.csv TO.csv MM     tables label,x,y,z; ends with 1 where a point is farther off than MM
// SPDX-License-Identifier: MIT
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <itkDisplacementFieldTransform.h>
#include <itkImageFileReader.h>

using Transform = itk::DisplacementFieldTransform<double, 3>;
using Field = Transform::DisplacementFieldType;
using Point = itk::Point<double, 3>;

static std::vector<Point> read_points(const char *path)
{
    std::vector<Point> points;
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        Point p;
        const size_t at = line.find(',', line.rfind('"') == std::string::npos ? 0 : line.rfind('"'));
        if (std::sscanf(line.c_str() + at, ",%lf,%lf,%lf", &p[0], &p[1], &p[2]) == 3)
            points.push_back(p);
    }
    return points;
}

int main(int argc, char **argv)
{
    if (argc != 5)
        return 2;
    const std::vector<Point> from = read_points(argv[2]), to = read_points(argv[3]);
    const double most = std::stod(argv[4]);
    auto transform = Transform::New();
    double worst = 0.0;
    try {
        transform->SetDisplacementField(itk::ReadImage<Field>(argv[1]));
    } catch (const itk::ExceptionObject &e) {
        std::cout << e << std::endl;
        return 2;
    }
    for (size_t i = 0; i < from.size() && from.size() == to.size(); i++)
        worst = std::max(worst, transform->TransformPoint(from[i]).EuclideanDistanceTo(to[i]));
    std::cout << from.size() << " points, worst " << worst << " mm" << std::endl;
    return !(from.size() > 1 && from.size() == to.size() && worst <= most);
}
