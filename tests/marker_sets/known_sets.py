"""Marker sets of laboratories and companies with the segment of each name, to test the dictionary of names against.

``#`` in a name stands for R and L (``%`` for r and l); the segment is then that of the side. Markers of a joint's
line count to the segment that human18 gives them to: epicondyles of the knee to the thigh, malleoli to the shank,
epicondyles of the elbow to the upper arm, styloids to the forearm. "" are points of no body or made by software.
"""

SIDED = ("upper_arm", "forearm", "hand", "thigh", "shank", "foot", "toes")

BUILT_ON = {
    # BioBuddy (pyomeca), static and functional trials
    "pyomeca": {
        "head": "HV OCC LTEMP RTEMP SEL",
        "torso": "C7 T10 SUP STR #A",
        "upper_arm": "#LHE #MHE LARM1 LARM2 LARM3 RAMR1 RARM2 RARM3",
        "forearm": "#US #RS #FARM1 #FARM2 #FARM3",
        "hand": "#HMH5 #HMH2 #FT3",
        "pelvis": "#PSIS #ASIS",
        "thigh": "#GT #LFE #MFE #THI1 #THI2 #THI3",
        "shank": "#LM #SPH #ATT #LEG1 #LEG2 #LEG3",
        "foot": "#CAL #MFH5 #MFH1",
        "toes": "#TT2",
    },
    # Duarte, legs and pelvis in Cortex
    "bmc_lower": {
        "pelvis": "#.ASIS #.PSIS #.Iliac.Crest",
        "thigh": "#.GTR #.Knee #.Knee.Medial",
        "shank": "#.HF #.TT #.Ankle #.Ankle.Medial",
        "foot": "#.Heel #.MT1 #.MT2 #.MT5",
    },
    # C3D encodings' trial: four plates of markers
    "clusters": {
        "foot": "#FT1 #FT2 #FT3",
        "shank": "#SK1 #SK2 #SK3 #SK4",
        "thigh": "#TH1 #TH2 #TH3 #TH4",
        "pelvis": "PV1 PV2 PV3 pv4",
    },
    "cgm24": {
        "pelvis": "#ASI #PSI",
        "thigh": "#THI #THAP #THAD #KNE",
        "shank": "#TIB #TIAP #TIAD #ANK",
        "foot": "#HEE #TOE #FMH #VMH",
    },
    # Schreiber & Moissenet, Sci. Data 6 (2019) 111, after Van Sint Jan
    "rehazenter": {
        "pelvis": "#_IAS #_IPS",
        "thigh": "#_FTC #_FLE #_FME",
        "shank": "#_FAX #_TTC #_FAL #_TAM",
        "foot": "#_FCC #_FM1 #_FM2 #_FM5",
        "torso": "CV7 TV10 SXS SJN #_SIA #_SRS #_SAA #_SAE",
        "upper_arm": "#_HLE #_HME",
        "forearm": "#_UOA #_RSP #_UHE",
        "hand": "#_HM2 #_HM5",
    },
    # Sprint of an amputee's partner, AddBiomechanics
    "sprint": {
        "torso": "C7 #SH MAN T7",
        "pelvis": "#ASI SACR",
        "upper_arm": "#ARM #ELB",
        "forearm": "#FOREARM #WR",
        "thigh": "#LEPI #THAD #THAP #THLD #THLP",
        "shank": "#LMAL #TIAD #TIAP #TILAT",
        "foot": "#HEEL #MFL #MFS #P1MT #P5MT #TOE",
        "": "x52 x53",
    },
    # Javelin, AddBiomechanics (Italian: Rx, Lx)
    "javelin": {
        "head": "#xCheec",
        "torso": "C7 #xShould",
        "upper_arm": "#xElbow",
        "forearm": "#xWrist",
        "pelvis": "#xAsis Psis",
        "thigh": "#xThigh #xLatCon",
        "shank": "#xFH #xShank #xLatMal",
        "foot": "#xHeel #xMeta5",
        "toes": "#xToe1",
    },
    # Stanford, with points that software made
    "gait_retraining": {
        "thigh": "r_knee L_knee r_mknee L_mknee r_thigh1 L_thigh1 r_thigh5",
        "shank": "r_shank(antsup) L_shank(ant_sup) r_ankle L_ankle r_mankle L_mankle r_sh2 L_sh2 r_sh3 r_sh4",
        "foot": "r_calc L_calc r_5meta L_5meta",
        "pelvis": "r.ASIS r.PSIS L.ASIS L.PSIS #_HJC #_HJC_reg midPSIS midASIS midHJC midPelvis",
        "torso": "C7 #_Shoulder #_Sternum",
    },
    "leuven": {
        "head": "#FHD #BHD",
        "torso": "C7 T10 CLAV STRN RBAK #SHO",
        "upper_arm": "#UA1 #UA2 #UA3 #ELB",
        "forearm": "#LA1 #LA2 #LA3 #WRA #WRB",
        "hand": "#FIN",
        "pelvis": "#ASI SACR #PSI Pelvis1 Pelvis2 Pelvis3",
        "thigh": "#THI #THI2 #THI3 #KNE",
        "shank": "#TIB #TIB2 #TIB3 #ANK",
        "foot": "#HEE #TOE #LatFoot",
    },
    # van den Bogert et al., Med. Biol. Eng. Comput. 51 (2013) 1069-1077
    "hbm": {
        "pelvis": "#ASIS #PSIS SACR NAVE",
        "thigh": "#GTRO #LEK F#THI",
        "shank": "#LM #ATI",
        "foot": "#TOE #HEE #MT5",
        "torso": "#SHO XYPH C7 T10 STRN BBAC",
        "upper_arm": "#LEE #MEE #DELT",
        "forearm": "#LW #MW #FRM",
        "hand": "#FIN",
        "head": "THEAD #HEAD FHEAD",
    },
    "optitrack_biomech": {
        "head": "#AH #PH",
        "torso": "SJN SXS CV7 TV2 TV7 #CAJ",
        "upper_arm": "#HGT #HLE #HME #UA",
        "forearm": "#USP #RSP",
        "hand": "#HM2",
        "pelvis": "#IAS #IPS",
        "thigh": "#FTC #FLE #FME #TH",
        "shank": "#SK #TTC #FAX #FAL #TAM",
        "foot": "#FM5 #FM1 #FM2 #FCC",
    },
    "qualisys_animation": {
        "head": "Q_Head# Q_HeadFront Q_HeadTop",
        "torso": "Q_SpineTop Q_SpineThoracic12 Q_Chest Q_Back# Q_#ShoulderTop Q_#ShoulderBack",
        "upper_arm": "Q_#Arm Q_#ElbowOut Q_#ElbowIn",
        "forearm": "Q_#WristOut Q_#WristIn",
        "hand": "Q_#HandIn Q_#HandOut",
        "pelvis": "Q_Waist#Front Q_Waist#Back Q_Waist# Q_WaistBack",
        "thigh": "Q_#Thigh Q_#KneeOut Q_#KneeIn",
        "shank": "Q_#Shin Q_#AnkleOut",
        "foot": "Q_#HeelBack Q_#ForefootOut Q_#ForefootIn",
        "toes": "Q_#ToeTip",
    },
    "motive_baseline": {
        "head": "HeadTop HeadFront HeadSide",
        "torso": "BackTop BackLeft BackRight Chest ChestTop #ShoulderBack",
        "upper_arm": "#UArmHigh #ElbowOut",
        "forearm": "#WristOut #WristIn #FArm",
        "hand": "#HandOut",
        "pelvis": "Waist#Front Waist#Back",
        "thigh": "#ThighSide #KneeOut #KneeIn",
        "shank": "#Shin #AnkleOut #AnkleIn",
        "foot": "#ToeIn #ToeOut #Heel",
        "toes": "#ToeTip",
    },
    # Mandery et al., IEEE Trans. Robot. 32 (2016) 796-809
    "kit": {
        "head": "#FHD #BHD",
        "torso": "CLAV STRN C7 T10 #BAK #SHO",
        "pelvis": "L3",
        "upper_arm": "#UPA #AEL",
        "forearm": "#AOL #FRA #WTS #WPS",
        "hand": "#HTS #HPS #IFD",
    },
    "kinetics_toolkit": {
        "head": "HeadVertex Sellion",
        "torso": "C7 Suprasternale Acromion#",
        "pelvis": "PubicSymphysis AnteriorSuperiorIliacSpine# PosteriorSuperiorIliacSpine# HipJointCenter#",
        "upper_arm": "LateralHumeralEpicondyle# MedialHumeralEpicondyle# GlenohumeralJointCenter#",
        "forearm": "UlnarStyloid# RadialStyloid#",
        "hand": "CarpalMetaHead2# CarpalMetaHead5#",
        "thigh": "LateralFemoralEpicondyle# MedialFemoralEpicondyle#",
        "shank": "LateralMalleolus# MedialMalleolus# KneeJointCenter#",
        "foot": "Calcaneus# Navicular# TarsalMetaHead1# TarsalMetaHead5#",
    },
    "visual3d": {
        "pelvis": "#IC",
        "thigh": "#GT #LK #MK #TH1 #TH2",
        "shank": "#LA #MA #SK1 #TUB",
        "foot": "#FT1 #FT2",
    },
    # Loper et al., ACM Trans. Graph. 33 (2014) 220
    "mosh": {
        "head": "ARIEL #BHD #FHD",
        "torso": "C7 CLAV STRN T10 #BSH #FSH",
        "upper_arm": "#UPA #ELB #IEL",
        "forearm": "#OWR #IWR",
        "pelvis": "#BWT #FWT #MWT",
        "thigh": "#THI #KNE #KNI",
        "shank": "#SHN #ANK",
        "foot": "#HEE #MT1 #MT5 #TOE",
    },
}
"""Sets that the dictionary was written with."""


def markers(groups: dict[str, str]) -> dict[str, str]:
    """Segment of each name of a set."""
    segments = {}
    for segment, names in groups.items():
        for name in names.split():
            for mark, letters in (("#", "RL"), ("%", "rl")):
                if mark in name:
                    for letter, side in zip(letters, ("right", "left"), strict=True):
                        sided = f"{side}_{segment}" if segment in SIDED else segment
                        segments[name.replace(mark, letter)] = sided
                    break
            else:
                segments[name] = f"{side_of(name)}_{segment}" if segment in SIDED else segment
    return segments


def side_of(name: str) -> str:
    """Side of a name that is told in full: by its first letter."""
    return "right" if name[0] in "Rr" else "left"
