!> Laws of solids at finite strain: Kirchhoff stress, spatial tangent and energy of a deformation.
!>
!> Hencky: the energy is Hooke's in logarithmic strains, W = bulk/2 (ln J)^2 + shear dev e : dev e
!> per reference volume, so Kirchhoff stress is Hooke's matrix times logarithmic strain. It is how
!> Lopin reads *ELASTIC under NLGEOM: a choice. Abaqus integrates a rate form (hypoelastic, with
!> logarithmic strain in the output), which agrees for elastic strains that stay moderate or do not
!> turn; CalculiX takes St Venant-Kirchhoff (Hooke in Green strain), which loses its stiffness at a
!> compression to 1/sqrt(3) and collapses, what an elastic body under a tool must not do. All three
!> have the same limit at small strain.
!>
!> St Venant-Kirchhoff, *ELASTIC, STRAIN=GREEN: W = lame/2 (tr E)^2 + shear E : E of Green's strain.
!>
!> Neo-Hooke as *HYPERELASTIC, NEO HOOKE: W = C10 (I1bar - 3) + (J - 1)^2/D1, shear = 2 C10,
!> bulk = 2/D1.
!>
!> The change of volume is given apart from b, so that an element may replace it by its mean; then
!> stress and tangent are those of the deformation so scaled.
!>
!> Plasticity is a radial return in Hencky's law: b is then that of the elastic part of a trial
!> deformation in which nothing flows, F Cp^-1 F^T with the plastic metric of the last accepted
!> increment, and a point remembers what module material_memory lists.
module lopin_hyperelastic
   use lopin_kinds, only : wp
   use lopin_log_strain, only : log_frame_type, new_log_frame, frame_stress, frame_tangent, &
      & frame_strain, log_one_plus, exp_minus_one
   use lopin_flow_curve, only : flow_type, flows, flow_at
   use lopin_radial_return, only : return_type, return_radially
   use lopin_plastic_return, only : plastic_type
   implicit none
   private
   public :: solid_law_type, finite_law, hencky_law, green_law, neo_hooke_law, finite_response
   public :: log_strain, total_change
   public :: thickness_change, condense_thickness, volume_change, elastic_constants
   public :: past_type, give_flow, flow_of_trial, answer_of

   type :: laws
      integer :: hencky = 1, neo_hooke = 2, green = 3
   end type laws
   type(laws), parameter :: finite_law = laws()

   type :: solid_law_type
      integer :: kind = 1                !! finite_law%...
      real(wp) :: shear = 0.0_wp         !! shear modulus at zero strain [stress]
      real(wp) :: bulk = 0.0_wp          !! bulk modulus at zero strain [stress]
      logical :: flows = .false.         !! plastic or viscous: Hencky's law with a radial return
      logical :: remembers = .false.     !! its points have a memory: it flows, or its stress-free
                                         !! state is another than the reference shape
      type(flow_type) :: flow
      type(plastic_type), allocatable :: plastic   !! where the yield surface is not von Mises' or
                                         !! moves: then module material_point returns to it
   end type solid_law_type

   !> What a law reads of the past, and of the temperature.
   type :: past_type
      real(wp) :: strain = 0.0_wp        !! accumulated plastic strain of the accepted state
      real(wp) :: dt = 1.0_wp            !! since then, > 0 [time]
      real(wp) :: offset = 0.0_wp        !! elastic ln J beyond that of the deformation [-]
      real(wp) :: temperature = 0.0_wp   !! of laws that look at it [temperature]
   end type past_type

contains

   !> Linear between Kirchhoff stress and logarithmic strain (Hencky).
   pure function hencky_law(young, poisson) result(law)
      real(wp), intent(in) :: young      !! E > 0 [stress]
      real(wp), intent(in) :: poisson    !! in (-1, 0.5) [-]
      type(solid_law_type) :: law
      law%kind = finite_law%hencky
      law%shear = 0.5_wp*young/(1.0_wp + poisson)
      law%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
   end function hencky_law

   !> Hooke's law in Green's strain, St Venant-Kirchhoff.
   pure function green_law(young, poisson) result(law)
      real(wp), intent(in) :: young      !! E > 0 [stress]
      real(wp), intent(in) :: poisson    !! in (-1, 0.5) [-]
      type(solid_law_type) :: law
      law = hencky_law(young, poisson)
      law%kind = finite_law%green
   end function green_law

   !> Neo-Hooke by the constants of *HYPERELASTIC.
   pure function neo_hooke_law(c10, d1) result(law)
      real(wp), intent(in) :: c10        !! > 0 [stress]
      real(wp), intent(in) :: d1         !! > 0 [1/stress]
      type(solid_law_type) :: law
      law%kind = finite_law%neo_hooke
      law%shear = 2.0_wp*c10
      law%bulk = 2.0_wp/d1
   end function neo_hooke_law

   !> Let the law of an elastic solid flow.
   pure subroutine give_flow(law, flow)
      type(solid_law_type), intent(inout) :: law
      type(flow_type), intent(in) :: flow
      law%flow = flow
      law%flows = flows(flow)
      law%remembers = law%flows
   end subroutine give_flow

   !> Young's modulus and Poisson's ratio of small strains.
   pure subroutine elastic_constants(law, young, poisson)
      type(solid_law_type), intent(in) :: law
      real(wp), intent(out) :: young, poisson
      young = 9.0_wp*law%bulk*law%shear/(3.0_wp*law%bulk + law%shear)
      poisson = 0.5_wp*(3.0_wp*law%bulk - 2.0_wp*law%shear)/(3.0_wp*law%bulk + law%shear)
   end subroutine elastic_constants

   !> J - 1 of the displacement gradient h, with all digits also for small h.
   pure real(wp) function volume_change(h) result(change)
      real(wp), intent(in) :: h(3, 3)

      change = h(1, 1) + h(2, 2) + h(3, 3) &
         & + (h(1, 1)*h(2, 2) - h(1, 2)*h(2, 1)) + (h(1, 1)*h(3, 3) - h(1, 3)*h(3, 1)) &
         & + (h(2, 2)*h(3, 3) - h(2, 3)*h(3, 2)) &
         & + h(1, 1)*(h(2, 2)*h(3, 3) - h(2, 3)*h(3, 2)) &
         & - h(1, 2)*(h(2, 1)*h(3, 3) - h(2, 3)*h(3, 1)) &
         & + h(1, 3)*(h(2, 1)*h(3, 2) - h(2, 2)*h(3, 1))
   end function volume_change

   !> Kirchhoff stress, energy per reference volume and, if asked for, the spatial tangent.
   pure subroutine finite_response(law, past, change, own, volume, stress, energy, tangent)
      type(solid_law_type), intent(in) :: law
      type(past_type), intent(in) :: past
      real(wp), intent(in) :: change(3, 3)            !! b - 1
      real(wp), intent(in) :: own                     !! J - 1 of b itself
      real(wp), intent(in) :: volume                  !! J - 1 that counts
      real(wp), contiguous, intent(out) :: stress(:)  !! (4 or 6) [stress]
      real(wp), intent(out) :: energy                 !! [stress]
      real(wp), contiguous, intent(out), optional :: tangent(:, :)   !! (4, 4) or (6, 6) [stress]

      if (law%kind == finite_law%neo_hooke) then
         call neo_hooke_response(law, change, own, volume, stress, energy, tangent)
      else if (law%kind == finite_law%green) then
         call green_response(law, change, own, volume, stress, energy, tangent)
      else
         call hencky_response(law, past, change, volume, stress, energy, tangent)
      end if
   end subroutine finite_response

   pure subroutine hencky_response(law, past, change, volume, stress, energy, tangent)
      type(solid_law_type), intent(in) :: law
      type(past_type), intent(in) :: past
      real(wp), intent(in) :: change(3, 3), volume
      real(wp), contiguous, intent(out) :: stress(:)
      real(wp), intent(out) :: energy
      real(wp), contiguous, intent(out), optional :: tangent(:, :)
      type(log_frame_type) :: frame
      type(return_type) :: back
      real(wp) :: deviator(3), principal(3), slope(3, 3), secant(3), dilatation, square
      integer :: k

      call new_log_frame(frame, change)
      dilatation = log_one_plus(volume) + past%offset
      deviator = frame%e - (frame%e(1) + frame%e(2) + frame%e(3))/3.0_wp
      square = deviator(1)**2 + deviator(2)**2 + deviator(3)**2
      back = answer_of(law, past, sqrt(square))
      principal = back%secant*deviator + law%bulk*dilatation
      stress = frame_stress(frame, principal, size(stress))
      energy = 0.5_wp*law%bulk*dilatation**2 + law%shear*back%kept**2*square
      if (.not. present(tangent)) return
      slope = law%bulk - back%secant/3.0_wp
      do k = 1, 3
         slope(k, k) = slope(k, k) + back%secant
      end do
      if (abs(back%along) > 0.0_wp) then
         do k = 1, 3
            slope(:, k) = slope(:, k) + (back%along*deviator(k)/square)*deviator
         end do
      end if
      secant = back%secant
      call frame_tangent(frame, principal, slope, secant, tangent)
   end subroutine hencky_response

   !> What the law makes of a trial deviator of strain.
   pure recursive function answer_of(law, past, magnitude) result(back)
      type(solid_law_type), intent(in) :: law
      type(past_type), intent(in) :: past
      real(wp), intent(in) :: magnitude      !! sqrt(e:e)
      type(return_type) :: back

      if (law%flows) then
         if (allocated(law%flow%temperature)) then
            back = answer_at_temperature(law, past, magnitude)
         else
            back = return_radially(law%flow, law%shear, magnitude, past%strain, past%dt)
         end if
      else
         back%secant = 2.0_wp*law%shear
      end if
   end function answer_of

   !> The same of tables for several temperatures; apart, so that the usual answer has one way.
   pure function answer_at_temperature(law, past, magnitude) result(back)
      type(solid_law_type), intent(in) :: law
      type(past_type), intent(in) :: past
      real(wp), intent(in) :: magnitude      !! sqrt(e:e)
      type(return_type) :: back
      type(solid_law_type) :: one

      one = law
      one%flow = flow_at(law%flow, past%temperature)
      back = answer_of(one, past, magnitude)
   end function answer_at_temperature

   !> Plastic flow of a trial deformation: its answer, and what it takes from b.
   pure subroutine flow_of_trial(law, past, change, back, frame, taken)
      type(solid_law_type), intent(in) :: law
      type(past_type), intent(in) :: past
      real(wp), intent(in) :: change(3, 3)   !! b - 1 of the trial
      type(return_type), intent(out) :: back
      type(log_frame_type), intent(out) :: frame   !! of the trial
      real(wp), intent(out) :: taken(3)      !! b after flow minus b of the trial, along its axes
      real(wp) :: deviator(3)

      call new_log_frame(frame, change)
      deviator = frame%e - (frame%e(1) + frame%e(2) + frame%e(3))/3.0_wp
      back = answer_of(law, past, sqrt(deviator(1)**2 + deviator(2)**2 + deviator(3)**2))
      taken = 0.0_wp
      if (back%step > 0.0_wp) taken = (1.0_wp + frame%change) &
         & *exp_minus_one(-2.0_wp*(1.0_wp - back%kept)*deviator)
   end subroutine flow_of_trial

   pure subroutine neo_hooke_response(law, change, own, volume, stress, energy, tangent)
      type(solid_law_type), intent(in) :: law
      real(wp), intent(in) :: change(3, 3), own, volume
      real(wp), contiguous, intent(out) :: stress(:)
      real(wp), intent(out) :: energy
      real(wp), contiguous, intent(out), optional :: tangent(:, :)
      real(wp) :: trace, isochoric, first, pressure, deviator(size(stress))
      integer :: k

      trace = change(1, 1) + change(2, 2) + change(3, 3)
      isochoric = exp_minus_one(-2.0_wp/3.0_wp*log_one_plus(own))   ! J**(-2/3) - 1
      first = (1.0_wp + isochoric)*trace + 3.0_wp*isochoric         ! I1bar - 3
      deviator(:3) = [change(1, 1), change(2, 2), change(3, 3)] - trace/3.0_wp
      deviator(4) = change(1, 2)
      if (size(stress) == 6) deviator(5:) = [change(1, 3), change(2, 3)]
      deviator = law%shear*(1.0_wp + isochoric)*deviator
      pressure = law%bulk*volume*(1.0_wp + volume)
      stress = deviator
      stress(:3) = stress(:3) + pressure
      energy = 0.5_wp*(law%shear*first + law%bulk*volume**2)
      if (.not. present(tangent)) return
      tangent = 0.0_wp
      tangent(:3, :3) = law%bulk*(1.0_wp + volume)*(1.0_wp + 2.0_wp*volume) &
         & - 2.0_wp/9.0_wp*law%shear*(first + 3.0_wp)
      do k = 1, size(stress)
         tangent(k, k) = tangent(k, k) &
            & + merge(2.0_wp, 1.0_wp, k <= 3)*(law%shear*(first + 3.0_wp)/3.0_wp - pressure)
      end do
      do k = 1, 3
         tangent(:, k) = tangent(:, k) - 2.0_wp/3.0_wp*deviator
         tangent(k, :) = tangent(k, :) - 2.0_wp/3.0_wp*deviator
      end do
   end subroutine neo_hooke_response

   !> With B = b - 1 of the scaled deformation: E has its invariants, halved, and tau = b S b^T.
   pure subroutine green_response(law, change, own, volume, stress, energy, tangent)
      type(solid_law_type), intent(in) :: law
      real(wp), intent(in) :: change(3, 3), own, volume
      real(wp), contiguous, intent(out) :: stress(:)
      real(wp), intent(out) :: energy
      real(wp), contiguous, intent(out), optional :: tangent(:, :)
      integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
      real(wp) :: lame, trace, scaled, big(3, 3), b(3, 3), tau(3, 3)
      integer :: i, k

      lame = law%bulk - 2.0_wp/3.0_wp*law%shear
      scaled = exp_minus_one(2.0_wp/3.0_wp*(log_one_plus(volume) - log_one_plus(own)))
      big = (1.0_wp + scaled)*change
      do k = 1, 3
         big(k, k) = big(k, k) + scaled
      end do
      b = big
      do k = 1, 3
         b(k, k) = b(k, k) + 1.0_wp
      end do
      trace = big(1, 1) + big(2, 2) + big(3, 3)
      tau = 0.5_wp*lame*trace*b + law%shear*matmul(b, big)
      do k = 1, size(stress)
         stress(k) = tau(row(k), column(k))
      end do
      energy = 0.125_wp*lame*trace**2 + 0.25_wp*law%shear*sum(big**2)
      if (.not. present(tangent)) return
      do k = 1, size(stress)
         do i = 1, size(stress)
            tangent(i, k) = lame*b(row(i), column(i))*b(row(k), column(k)) &
               & + law%shear*(b(row(i), row(k))*b(column(i), column(k)) &
               & + b(row(i), column(k))*b(column(i), row(k)))
         end do
      end do
   end subroutine green_response

   !> b - 1 of a displacement gradient.
   pure function total_change(h) result(change)
      real(wp), intent(in) :: h(3, 3)        !! F - 1
      real(wp) :: change(3, 3)
      integer :: j

      do j = 1, 3
         change(:, j) = h(:, j) + h(j, :) + (h(:, 1)*h(j, 1) + h(:, 2)*h(j, 2) + h(:, 3)*h(j, 3))
      end do
   end function total_change

   !> Logarithmic strain of the deformation scaled to a change of volume; engineering shears.
   pure function log_strain(change, volume) result(strain)
      real(wp), intent(in) :: change(3, 3)   !! b - 1
      real(wp), intent(in) :: volume         !! J - 1
      real(wp) :: strain(6)
      type(log_frame_type) :: frame

      call new_log_frame(frame, change)
      strain = frame_strain(frame, frame%e + (log_one_plus(volume) - sum(frame%e))/3.0_wp)
   end function log_strain

   !> Plane stress: the stretch - 1 through the thickness at which the stress across it vanishes
   !> if nothing flows.
   pure real(wp) function thickness_change(law, past, metric, change, area) result(thickness)
      type(solid_law_type), intent(in) :: law
      type(past_type), intent(in) :: past
      real(wp), intent(in) :: metric         !! plastic metric through the thickness [-]
      real(wp), intent(in) :: change(3, 3)   !! b - 1 in the plane
      real(wp), intent(in) :: area           !! stretch of the area in the plane - 1
      real(wp) :: lame, low, high, d, new, value, slope, square, scale
      integer, parameter :: most = 60
      integer :: i

      if (law%kind == finite_law%hencky) then
         lame = law%bulk - 2.0_wp/3.0_wp*law%shear
         thickness = exp_minus_one(-(lame*log_one_plus(area) + law%bulk*past%offset &
            & + law%shear*log_one_plus(metric))/(lame + 2.0_wp*law%shear))
         return
      else if (law%kind == finite_law%green) then
         lame = law%bulk - 2.0_wp/3.0_wp*law%shear
         d = -lame/(lame + 2.0_wp*law%shear)*(change(1, 1) + change(2, 2))
         ! Stretched so far in the plane that no thickness is free of stress: nothing is left of it.
         d = max(d, epsilon(d) - 1.0_wp)
         thickness = d/(1.0_wp + sqrt(1.0_wp + d))
         return
      end if
      ! shear (2 J**2/A**2 - tr b)/3 + bulk (J**(8/3) - J**(5/3)) = 0 falls, then rises with J: one
      ! root, between those of its two parts. d = J - 1, A = 1 + area, square = A**2 tr b/2 - 1.
      square = area*(2.0_wp + area) + 0.5_wp*(change(1, 1) + change(2, 2))*(1.0_wp + area)**2
      d = square/(1.0_wp + sqrt(1.0_wp + square))
      low = min(0.0_wp, d)
      high = max(0.0_wp, d)
      scale = high - low
      d = high
      do i = 1, most
         value = 2.0_wp/3.0_wp*law%shear*(d*(2.0_wp + d) - square)/(1.0_wp + area)**2 &
            & + law%bulk*(1.0_wp + d)**(5.0_wp/3.0_wp)*d
         slope = 4.0_wp/3.0_wp*law%shear*(1.0_wp + d)/(1.0_wp + area)**2 &
            & + law%bulk*(1.0_wp + d)**(2.0_wp/3.0_wp)*(3.0_wp + 8.0_wp*d)/3.0_wp
         if (value > 0.0_wp) high = d
         if (value <= 0.0_wp) low = d
         new = 0.5_wp*(low + high)
         if (slope > 0.0_wp) then
            if (d - value/slope >= low .and. d - value/slope <= high) new = d - value/slope
         end if
         if (abs(new - d) <= epsilon(d)*scale) exit
         d = new
      end do
      thickness = (d - area)/(1.0_wp + area)
   end function thickness_change

   !> Take the strain through the thickness out of a tangent in plane stress.
   pure subroutine condense_thickness(tangent)
      real(wp), intent(inout) :: tangent(4, 4)
      real(wp) :: column(4), pivot
      integer :: k

      column = tangent(:, 3)
      pivot = tangent(3, 3)
      do k = 1, 4
         tangent(:, k) = tangent(:, k) - column*(column(k)/pivot)
      end do
      tangent(:, 3) = 0.0_wp
      tangent(3, :) = 0.0_wp
   end subroutine condense_thickness
end module lopin_hyperelastic
