"""The formats that are known."""

from sk120stiff.measurements.importers.contract import Formats
from sk120stiff.measurements.importers.figaroh import Figaroh
from sk120stiff.measurements.importers.joint_tables import DELMIA, ROBODK
from sk120stiff.measurements.importers.leica import Leica
from sk120stiff.measurements.importers.points import Points
from sk120stiff.measurements.importers.polyworks import PolyWorks
from sk120stiff.measurements.importers.ros_bag import RosBag
from sk120stiff.measurements.importers.spatial_analyzer import SpatialAnalyzer

FORMATS = Formats(
    (RosBag(), SpatialAnalyzer(), Leica(), PolyWorks(), ROBODK, DELMIA, Figaroh(), Points())
)
