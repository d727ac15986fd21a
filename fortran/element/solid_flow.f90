!> Solids at small strain whose material flows: force, tangent, stress and memory of one element.
!>
!> The same laws as at finite strain, in the small strains of the B matrices (mean dilatation
!> included). Arguments are those of module solid_finite_strain, so that an assembly calls
!> either.
module lopin_solid_flow
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_kind
   use lopin_element_input, only : element_input_type
   use lopin_solid_small, only : strain_matrices, strains, internal_force, add_product, &
      & mode_strains, follow_nodes
   use lopin_enhanced_modes, only : solve_small
   use lopin_hyperelastic, only : solid_law_type, elastic_constants
   use lopin_von_mises, only : von_mises_slope
   use lopin_hourglass, only : add_hourglass, moduli_type
   use lopin_material_memory, only : amplitudes_of, put_amplitudes, offset_at, stress_at
   use lopin_material_point, only : small_answer_type, respond_small, keep_small
   implicit none
   private
   public :: flow_element, flow_stresses, flow_memory, has_flow_slopes, flow_slopes

contains

   !> Force, elastic energy and, if asked for, tangent of an element.
   pure subroutine flow_element(element, input, force, energy, bad, ke)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: force(element%ndof)   !! internal forces [force]
      real(wp), intent(out) :: energy                !! [force length]
      integer, intent(out) :: bad            !! 0; 1 where the internal modes find no balance
      real(wp), intent(out), optional :: ke(element%ndof, element%ndof)   !! [force/length]
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss)
      real(wp) :: stress(element%nstress, element%ngauss), strain(element%nstress, element%ngauss)
      real(wp) :: alpha(element%nmode)
      type(moduli_type) :: moduli
      type(small_answer_type) :: answer
      integer :: i, k, m

      call trial(element, input, b, volume, strain, alpha, bad)
      if (bad > 0) return
      m = element%nstress
      if (present(ke)) ke = 0.0_wp
      energy = 0.0_wp
      do k = 1, element%ngauss
         call respond_small(input%law, element%kind == element_kind%plane_stress, &
            & input%memory(:, k), input%dt, strain(:, k), answer)
         if (.not. answer%found) then
            bad = k
            return
         end if
         stress(:, k) = answer%stress(:m)
         energy = energy + 0.5_wp*volume(k)*input%law%bulk*answer%trace**2 &
            & + volume(k)*input%law%shear*answer%distortion**2
         if (.not. present(ke)) cycle
         call add_product(element%ndof, m, b(:, :, k), volume(k)*answer%tangent(:m, :m), ke)
      end do
      call internal_force(element, b, volume, stress, force)
      if (present(ke)) then
         do i = 2, element%ndof
            ke(:i - 1, i) = ke(i, :i - 1)
         end do
      end if
      if (.not. element%hourglass) return
      moduli%thickness = input%thickness
      call elastic_constants(input%law, moduli%young, moduli%poisson)
      call add_hourglass(element, moduli, input%x, input%u, .false., force, energy, ke)
   end subroutine flow_element

   !> Stress and strain (engineering shears) at the Gauss points: xx yy zz xy xz yz.
   pure subroutine flow_stresses(element, input, stress, strain, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: stress(6, element%ngauss)     !! [stress]
      real(wp), intent(out) :: strain(6, element%ngauss)     !! [-]
      integer, intent(out) :: bad                            !! as for flow_element
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss)
      real(wp) :: own(element%nstress, element%ngauss), alpha(element%nmode)
      type(small_answer_type) :: answer
      integer :: k, m

      m = element%nstress
      stress = 0.0_wp
      strain = 0.0_wp
      call trial(element, input, b, volume, own, alpha, bad)
      if (bad > 0) return
      do k = 1, element%ngauss
         call respond_small(input%law, element%kind == element_kind%plane_stress, &
            & input%memory(:, k), input%dt, own(:, k), answer)
         stress(:m, k) = answer%stress(:m)
         strain(:m, k) = own(:, k)
         if (element%kind == element_kind%plane_stress) strain(3, k) = answer%across
         if (size(input%memory, 1) > 0) strain(:m, k) = strain(:m, k) &
            & - elastic_share(input%memory(:, k), m)
      end do
   end subroutine flow_stresses

   !> The memory of this state, to be kept once it is accepted, plastic work since the last, volume.
   pure subroutine flow_memory(element, input, next, work, held, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(inout) :: next(:, :)                  !! memory: a copy of that of the
                                                             !! accepted state, then of this
      real(wp), intent(out) :: work                          !! [force length]
      real(wp), intent(out) :: held                          !! deformed volume [length^3]
      integer, intent(out) :: bad                            !! as for flow_element
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss)
      real(wp) :: own(element%nstress, element%ngauss), alpha(element%nmode), density
      type(small_answer_type) :: answer
      integer :: k, m

      m = element%nstress
      work = 0.0_wp
      held = 0.0_wp
      call trial(element, input, b, volume, own, alpha, bad)
      if (bad > 0) return
      if (element%nmode > 0) call put_amplitudes(next, m, alpha)
      if (element%kind == element_kind%plane_stress) then
         do k = 1, element%ngauss
            call respond_small(input%law, .true., next(:, k), input%dt, own(:, k), answer)
            own(3, k) = answer%across
         end do
      end if
      held = sum(volume*(1.0_wp + own(1, :) + own(2, :) + own(3, :)))
      if (.not. input%law%flows) return
      do k = 1, element%ngauss
         call keep_small(input%law, input%dt, own(:, k), next(:, k), density)
         work = work + volume(k)*density
      end do
   end subroutine flow_memory

   !> The strain through the thickness that a surface of its own finds is not followed.
   pure logical function has_flow_slopes(element, law)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      has_flow_slopes = element%kind /= element_kind%plane_stress .or. .not. allocated(law%plastic)
   end function has_flow_slopes

   !> Slopes of rows: see finite_strain_slopes of module point_slopes.
   pure subroutine flow_slopes(element, input, flowing, row, slope, bad)
      type(element_type), intent(in) :: element    !! one of has_flow_slopes
      type(element_input_type), intent(in) :: input
      logical, intent(in) :: flowing(element%ngauss)
      real(wp), contiguous, intent(in) :: row(:, :, :)   !! (7, ngauss, nrow)
      real(wp), contiguous, intent(out) :: slope(:, :, :)   !! (ndim, nnode, nrow) [stress/length]
      integer, intent(out) :: bad                  !! as for flow_element
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss)
      real(wp) :: strain(element%nstress, element%ngauss), alpha(element%nmode)
      real(wp) :: flow(element%nstress), mises(6), w(element%nstress)
      type(small_answer_type) :: answer
      integer :: k, m, r

      slope = 0.0_wp
      call trial(element, input, b, volume, strain, alpha, bad)
      if (bad > 0) return
      m = element%nstress
      do k = 1, element%ngauss
         if (all(.not. abs(row(:, k, :)) > 0.0_wp)) cycle
         call respond_small(input%law, element%kind == element_kind%plane_stress, &
            & input%memory(:, k), input%dt, strain(:, k), answer)
         flow = 0.0_wp
         if (flowing(k) .and. allocated(input%law%plastic)) then
            call flow_by_differences(input, k, strain(:, k), flow)
         else if (flowing(k)) then
            mises = von_mises_slope(answer%stress)
            flow = matmul(answer%tangent(:m, :m), mises(:m))
         end if
         do r = 1, size(row, 3)
            w = matmul(answer%tangent(:m, :m), row(:m, k, r)) + row(7, k, r)*flow
            slope(:, :, r) = slope(:, :, r) &
               & + reshape(matmul(b(:, :, k), w), [element%ndim, element%nnode])
         end do
      end do
   end subroutine flow_slopes

   !> Slopes of the stress of flow in the strain of a point.
   pure subroutine flow_by_differences(input, k, strain, slope)
      type(element_input_type), intent(in) :: input
      integer, intent(in) :: k
      real(wp), intent(in) :: strain(:)
      real(wp), intent(out) :: slope(:)
      real(wp), parameter :: step = 1.0e-7_wp
      real(wp) :: next(size(input%memory, 1)), moved(size(strain)), flow(2), work
      integer :: r, side

      do r = 1, size(strain)
         do side = 1, 2
            moved = strain
            moved(r) = moved(r) + real(2*side - 3, wp)*step
            next = input%memory(:, k)
            call keep_small(input%law, input%dt, moved, next, work)
            flow(side) = next(stress_at(size(strain)))
         end do
         slope(r) = (flow(2) - flow(1))/(2.0_wp*step)
      end do
   end subroutine flow_by_differences

   !> Elastic strain (engineering shears) of every point if nothing flowed.
   pure subroutine trial(element, input, b, volume, strain, alpha, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: b(element%ndof, element%nstress, element%ngauss)
      real(wp), intent(out) :: volume(element%ngauss), strain(element%nstress, element%ngauss)
      real(wp), intent(out) :: alpha(element%nmode)   !! amplitudes of the internal modes
      integer, intent(out) :: bad
      real(wp) :: smallest
      integer :: k, point

      bad = 0
      call strain_matrices(element, input%x, input%thickness, b, volume, smallest, point)
      call strains(element, b, reshape(input%u(:, :element%nnode), [element%ndof]), strain)
      if (size(input%memory, 1) > 0) then
         do k = 1, element%ngauss
            strain(:, k) = strain(:, k) + elastic_share(input%memory(:, k), element%nstress)
         end do
      end if
      if (element%nmode > 0) call relax(element, input, volume, b, strain, alpha, bad)
   end subroutine trial

   !> Add the strains of the internal modes in balance, and their slopes to B: Newton, half way back
   !> where the forces on the modes grow.
   pure subroutine relax(element, input, volume, b, strain, alpha, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(in) :: volume(element%ngauss)
      real(wp), intent(inout) :: b(element%ndof, element%nstress, element%ngauss)
      real(wp), intent(inout) :: strain(element%nstress, element%ngauss)
      real(wp), intent(out) :: alpha(element%nmode)
      integer, intent(out) :: bad          !! 1: no balance found
      real(wp) :: own(element%nmode, element%nstress, element%ngauss)
      real(wp) :: tangent(element%nstress, element%nstress, element%ngauss)
      real(wp) :: size_of
      real(wp) :: pivot(element%nmode, element%nmode), step(element%nmode, 1)
      real(wp) :: force(element%nmode), before
      type(small_answer_type) :: answer
      integer, parameter :: most = 60, most_halvings = 6
      integer :: k, sweep, halvings
      logical :: regular

      call mode_strains(element, input%x, own)
      bad = 0
      size_of = maxval(abs(strain))
      if (size(input%memory, 1) > 0) size_of = size_of &
         & + maxval(abs(input%memory(:element%nstress, :)))
      alpha = amplitudes_of(input%memory, element%nstress, element%nmode)
      do k = 1, element%ngauss
         strain(:, k) = strain(:, k) + matmul(alpha, own(:, :, k))
      end do
      before = huge(1.0_wp)
      halvings = 0
      do sweep = 1, most
         pivot = 0.0_wp
         force = 0.0_wp
         do k = 1, element%ngauss
            call respond_small(input%law, element%kind == element_kind%plane_stress, &
               & input%memory(:, k), input%dt, strain(:, k), answer)
            tangent(:, :, k) = answer%tangent(:element%nstress, :element%nstress)
            force = force + volume(k)*matmul(own(:, :, k), answer%stress(:element%nstress))
            pivot = pivot + volume(k)*matmul(own(:, :, k), matmul(tangent(:, :, k), &
               & transpose(own(:, :, k))))
         end do
         if (norm2(force) > before .and. halvings < most_halvings) then
            halvings = halvings + 1
            step = 0.5_wp*step
            call go_back(own, -step(:, 1), alpha, strain)
            cycle
         end if
         halvings = 0
         before = norm2(force)
         step(:, 1) = force
         call solve_small(pivot, step, regular)
         if (.not. regular) exit
         call go_back(own, step(:, 1), alpha, strain)
         if (maxval(abs(step)) > 1.0e-8_wp*maxval(abs(alpha)) + 1.0e-14_wp*size_of) cycle
         call follow_nodes(element, own, tangent, volume, b)
         return
      end do
      bad = 1
   end subroutine relax

   !> Take `way` from the amplitudes, and what it means from the strains.
   pure subroutine go_back(own, way, alpha, strain)
      real(wp), intent(in) :: own(:, :, :)       !! (nmode, nstress, ngauss)
      real(wp), intent(in) :: way(:)
      real(wp), intent(inout) :: alpha(:), strain(:, :)
      integer :: k

      alpha = alpha - way
      do k = 1, size(strain, 2)
         strain(:, k) = strain(:, k) - matmul(way, own(:, :, k))
      end do
   end subroutine go_back

   !> Elastic strain minus total strain, engineering shears.
   pure function elastic_share(memory, nstress) result(strain)
      real(wp), intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp) :: strain(nstress)
      strain(:3) = 0.5_wp*memory(:3) + memory(offset_at(nstress))/3.0_wp
      strain(4:) = memory(4:nstress)
   end function elastic_share
end module lopin_solid_flow
