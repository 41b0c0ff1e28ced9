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

HELD_OUT = {
    # github.com/koonyook/rris40, markers.md
    "rris40": {
        "head": "#TEMP #HEAD",
        "torso": "#ACR STER XPRO C7 T10 T4 T8",
        "upper_arm": "#HLE #HME",
        "forearm": "#RSP #USP",
        "hand": "#CAP #HMC2",
        "pelvis": "#ASIS #PSIS #ICR",
        "thigh": "#FLE #FME",
        "shank": "#TAM #FAL",
        "foot": "#FCC #FMT1 #FMT5 #FMT2",
    },
    # github.com/opensim-org/opensim-core, JAM example, static1.trc
    "jam_knee": {
        "torso": "#.Shoulder #.Clavicle L.Scapula",
        "upper_arm": "#.Bicep #.Elbow #.Melb",
        "forearm": "#.Forearm #.Wrist",
        "pelvis": "#.ASIS #.PSIS S2",
        "thigh": "#.TH1 #.TH2 #.TH3 L.TH4 #.Knee #.GTR #.Mkn",
        "shank": "#.SH1 #.SH2 #.SH3 R.SH4 #.Ankle #.Man",
        "foot": "#.Heel #.MT5",
    },
    # github.com/RealTimeBiomechanics/rtosim, ik_taskset.xml
    "rtosim": {
        "torso": "#ACR C7 T10 CLAV STRN #ASH #PSH",
        "pelvis": "#ASI #PSI #HJC",
        "thigh": "#THU #THC #THD #FCL #FCM #THM",
        "shank": "#TBU #TBC #TBD #TBL #MALL #MALM #TCL #TCM #KJC",
        "foot": "#CAL #MT1 #MT5",
    },
    # a viewer of gait captures with this set (github, labeledSegments)
    "proximal_distal": {
        "head": "#FHD #BHD",
        "torso": "#ACR #SHO",
        "pelvis": "#ILCR #ASIS #PSIS MID_HJC MID_ASIS MID_PSIS",
        "upper_arm": "#LEB #MEB",
        "forearm": "#LWRT #MWRT",
        "hand": "#HAND",
        "thigh": "#GTR #THI #LEP #MEP",
        "shank": "#LMAL #MMAL #PSK #DSK",
        "foot": "#HEEL #MET5 #TOE",
    },
    # pyCGM2, upper limb (Model_UpperLimb.vst)
    "pycgm2_upper_limb": {
        "torso": "C7 T10 CLAV STRN #SHO",
        "upper_arm": "#UPA #UPB #UPC #ELB #MEP",
        "forearm": "#FRA #WRA #WRB",
        "hand": "#FIN",
    },
    # dos Santos & Duarte, PeerJ 4 (2016) e2648: balance, after Leardini
    "bmc_balance": {
        "head": "#.Front.Head #.Back.Head",
        "torso": "#.Shoulder C7 T2 T7 IJ PX",
        "pelvis": "L3 L5 #.ASIS #.PSIS #.Iliac.Crest",
        "thigh": "#.GRT #.Knee #.Knee.Medial",
        "shank": "#.HF #.TT #.Ankle #.Ankle.Medial",
        "foot": "#.Heel #.MT1 #.MT5 #.MT2",
    },
    # MoVi (Ghorbani et al., PLoS ONE 16 (2021) e0253157), markers of the body only
    "movi": {
        "head": "%fronthead %backhead %cheek",
        "torso": "backneck upperback clavicle sternum %back %shom %breast %scapula",
        "upper_arm": "%upperarm %elbm %elbinner",
        "forearm": "%forearm %writhumbside %wripinkieside",
        "hand": "%fin %thumb",
        "pelvis": "%asis %psis %bum",
        "thigh": "%frontthigh %thigh %knem %frontinnerthigh %innerknee",
        "shank": "%ankm %shin",
        "foot": "#Heel %fifthmetatarsal %firstmetatarsal",
        "toes": "#BigToe %fourthtoe",
    },
    # CMU (mocap.cs.cmu.edu)
    "cmu": {
        "head": "#FHD #BHD",
        "torso": "STRN CLAV T10 C7 RBAC #SHO",
        "upper_arm": "#UPA #ELB",
        "forearm": "#FRM #WRA #WRB",
        "hand": "#FIN",
        "pelvis": "#BWT #FWT",
        "thigh": "#THI #KNE",
        "shank": "#SHN #ANK",
        "foot": "#HEE #TOE #MT5",
    },
    # Wojtusch & von Stryk, HuMoD (Humanoids 2015)
    "humod": {
        "head": "TRA_# GLA",
        "torso": "C7 T8 T12 SUP ACR_#",
        "upper_arm": "LHC_#",
        "forearm": "WRI_#",
        "pelvis": "ASIS_# PSIS_# PS",
        "thigh": "GTR_# LFC_# MFC_#",
        "shank": "LM_# MM_#",
        "foot": "MT2_# MT5_# CAL_#",
        "toes": "HAL_#",
    },
    # Fukuchi et al., PeerJ 5 (2017) e3298: running
    "fukuchi_running": {
        "pelvis": "#ASIS #PSIS #ILC",
        "thigh": "#TTL #TBL #TTM #TBM #GTR #KNL #KNM",
        "shank": "#STL #SBL #STM #SBM #HFB #TTU #AKL #AKM",
        "foot": "#HET #HEB #HEL #MT1 #MT5 #MT2",
    },
    # Moissenet, InitialiseMarkerTrajectories
    "geneva_legs": {
        "pelvis": "#ASI #PSI",
        "thigh": "#GTR #THAP #THAD #THI1 #THI2 #KNE #KNM",
        "shank": "#FAX #TTA #TIAP #TIAD #TIB1 #TIB2 #ANK #MED",
        "foot": "#HEE #TOE #FMH #SMH #VMH",
    },
    # MAP client, gias2: pelvis and legs in one laboratory
    "map_client": {
        "torso": "C7 T10 CLAV STRN #SHO BackExtra",
        "upper_arm": "#TRI #ELB",
        "forearm": "#WRI",
        "pelvis": "#ASI VSAC #ILC #PSI",
        "thigh": "#GTR #KNE #KNM",
        "shank": "#S1 #S2 #S3 #ANK #ANM",
        "foot": "#HEE",
    },
    # BTS, Milan: running
    "bts_running": {
        "foot": "%Heel %Meta5 %Meta1",
        "shank": "%MalMed %MalExt",
        "thigh": "%KneeMed %KneeExt %Troc",
        "pelvis": "%ASIS %PSIS L2",
        "upper_arm": "%ElbMed %ElbExt",
        "forearm": "%WriMed %WriExt",
        "torso": "%Acro C7 cla",
    },
    # walking of young and old adults, Brazil (c3d_to_trc.py)
    "kneelat": {
        "pelvis": "#ASIS #PSIS",
        "thigh": "#THI #KNEELAT #KNEEMED",
        "shank": "#FIB #TIB #ANKLELAT #ANKLEMED",
        "foot": "#HEEL #TOEMED #TOELAT",
        "torso": "C7 CLAV T2",
    },
    # a robot's belt at the knee: R.TibTub and Plug-in Gait
    "tibtub": {
        "thigh": "#KNE #KNEEMED #THI",
        "shank": "#TIB #.TibTub #ANK #ANKMED",
        "foot": "#1MT #HEEL",
        "pelvis": "#ASI #PSI",
    },
}
"""Public sets that were read before their spellings went into the dictionary: 89 % of the names, 3.4 % of the sure
readings on a wrong segment."""


HELD_OUT_LATER = {
    # walking in OpenSim (github, set_up_ik_tool)
    "ik_study": {
        "torso": "Sternum #Shoulder",
        "pelvis": "#ASIS #PSIS",
        "shank": "#Fibula #Shank #AnkleLateral #AnkleMedial",
        "foot": "#MT5 #MT2 #Heel",
        "thigh": "#KneeLateral #KneeMedial",
    },
    # MAP client, gias2: a second laboratory
    "map_client_words": {
        "pelvis": "#Asis #Psis",
        "thigh": "#KneeLateral #KneeMedial #ThighSuperior #ThighInferior #ThighLateral",
        "shank": "#AnkleLateral #AnkleMedial #ShankSuperior #ShankInferior #ShankLateral",
        "torso": "#Shoulder",
        "foot": "#Heel #MidfootLateral",
    },
    # BioBuddy, lower limbs after Maldonado et al. 2018
    "biobuddy_legs": {
        "head": "#FHD #BHD",
        "torso": "C7 T10 CLAV STRN RBAK #SHO",
        "upper_arm": "#ELB #HUM",
        "forearm": "#WRA #WRB",
        "hand": "#FIN",
        "pelvis": "#ASI #PSI",
        "thigh": "#THI #THID #KNE #KNM #TROC",
        "shank": "#TIB #TIBP #TIBD #ANK #ANKM",
        "foot": "#HEE #TOE #5MH",
        "": "*51",
    },
    # running, Hamburg (github, markers_needed)
    "hamburg": {
        "pelvis": "#ASI #PSI",
        "thigh": "#TRO #KNE #KNEM",
        "shank": "#TIB #ANK #ANKM",
        "foot": "#CALL #CALM #HEE #LMT5 #LMT1 #TOE",
    },
    # lifting, a digital twin: box, sensors and a plate beside the body
    "lifting_twin": {
        "upper_arm": "#ELBL #ELBM",
        "forearm": "#WRL #WRM",
        "thigh": "#KNE",
        "shank": "#ANKL #ANKM",
        "foot": "#TOE #HEE",
        "pelvis": "#ASI #PSI",
        "torso": "MChest",
        "": "Box1 Box2 Box3 Box4 DL1 DL2 DL3 DH1 DH2 DH3",
    },
    "static_text": {
        "pelvis": "#_ASIS V_Sacral",
        "thigh": "#_Knee #_Knee_Med #_Thigh",
        "shank": "#_Ankle #_Ankle_Med #_Shank",
        "foot": "#_Heel #_Toe",
    },
    # a body in MATLAB after OpenSim
    "matlab_body": {
        "forearm": "#FAsuperior #WristMed #WristLat",
        "thigh": "#ThighUpper #ThighFront #ThighRear #KneeLat #KneeMed",
        "shank": "#ShankUpper #ShankFront #ShankRear #AnkleLat #AnkleMed",
        "foot": "#Heel #ToeLat #MidToeLat #MidToeMed #MidfootSup #MidfootLat",
        "toes": "#ToeTip",
    },
    # Waterloo, inertial sensors beside markers
    "waterloo": {
        "torso": "#_Shoulder",
        "pelvis": "#_ASIS",
        "thigh": "#_Knee_Med #_Knee_Lat",
        "shank": "#_Ankle_Med #_Ankle_Lat",
        "foot": "#_Toe #_Heel",
    },
    # names that a converter of captures looks for
    "converter": {
        "thigh": "#_FemCon_Med #_FemCon_Lat",
        "shank": "#_MedMalleolus #_LatMalleolus",
        "forearm": "#_WR_rad #_WR_uln",
        "upper_arm": "#_EL_med #_EL_lat",
        "foot": "#_1st_met #_5th_met #_calc",
        "pelvis": "#_HJC_reg",
    },
    # markers on an SMPL body
    "smpl_markers": {
        "head": "head_top head_front head_back",
        "torso": "sternum c7 t10 %_acromion",
        "pelvis": "sacrum %_asis %_psis",
        "upper_arm": "%_elbow_lat %_elbow_med",
        "forearm": "%_wrist",
        "thigh": "%_knee_lat %_knee_med",
        "shank": "%_ankle_lat %_ankle_med",
        "foot": "%_heel %_toe",
    },
    # Camargo et al., J. Biomech. 119 (2021) 110320
    "camargo": {
        "pelvis": "#_ASIS #_PSIS",
        "thigh": "#_Thigh_Front #_Thigh_Rear #_Thigh_Upper #_Knee_Lat",
        "shank": "#_Shank_Front #_Shank_Rear #_Shank_Upper #_Ankle_Lat",
        "foot": "#_Heel #_Toe_Lat #_Toe_Med",
        "toes": "#_Toe_Tip",
    },
    # opensim-core, FAIDC1_INITIAL_WALK01.trc: medial epicondyles of the knee
    "sandbox_walk": {
        "torso": "#SH C7",
        "upper_arm": "#ELB",
        "forearm": "#WR",
        "pelvis": "#ASI SACR",
        "thigh": "#THLP #THLD #THAP #THAD #LEPI #MEPI",
        "shank": "#TIAP #TIAD #TILAT #LMAL #MMAL",
        "foot": "#HEEL #MFS #MFL #P5MT #P1MT #TOE",
    },
}
"""Public sets of a second round, read when the spellings of the first were in and their own were not: 95 % of the
names, none of the 323 sure readings on a wrong segment."""


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
