!> History variables of a Gauss point that flows, as one column of reals.
!>
!> The plastic metric Cp^-1 - 1 stands in the order of stress (4 numbers in 2D, 6 in 3D; tensor
!> components), so that small plastic strains keep their digits: b of the trial is F Cp^-1 F^T. It
!> belongs to the reference shape, turns with nothing, and is minus twice the plastic strain where
!> strains are small. It keeps the volume: what heat and stresses of the start add to ln J of the
!> elastic part stands in the last row, which is written before an increment is solved. The two rows
!> before it belong to the element: the amplitudes of its internal modes, from where the next search
!> for their balance starts.
!>
!> Laws that ask for more have rows behind these: the temperature, and where the yield surface is of
!> a shape of its own or moves, the flow stress, the inverse of the plastic deformation less 1 (by
!> columns) and the parts of the backstress (Kelvin vectors on the axes of the material).
module lopin_material_memory
   use lopin_kinds, only : wp
   use lopin_log_strain, only : first_axis, second_axis
   use lopin_hyperelastic, only : past_type, solid_law_type
   use lopin_plastic_return, only : plastic_past_type, plastic_answer_type
   implicit none
   private
   public :: memory_size, past_of, metric_of, put_metric, trial_change, strain_at, stress_at, &
      & work_at, offset_at
   public :: amplitudes_of, put_amplitudes
   public :: rows_of, temperature_at, plastic_past_of, put_plastic, put_return, map_of, put_map

contains

   !> Numbers per point for `nstress` components of stress.
   pure integer function memory_size(nstress)
      integer, intent(in) :: nstress
      memory_size = nstress + 6
   end function memory_size

   !> The same with what a law asks for beyond it.
   pure integer function rows_of(law, nstress) result(rows)
      type(solid_law_type), intent(in) :: law
      integer, intent(in) :: nstress

      rows = memory_size(nstress)
      if (allocated(law%flow%temperature) .or. allocated(law%plastic)) rows = rows + 1
      if (allocated(law%plastic)) rows = rows + 10 + 6*law%plastic%kinematic%n
   end function rows_of

   !> Row of the temperature, where the law has it [temperature].
   pure integer function temperature_at(nstress)
      integer, intent(in) :: nstress
      temperature_at = nstress + 7
   end function temperature_at

   !> What the return to a surface reads.
   pure function plastic_past_of(memory, nstress, parts, dt) result(past)
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      integer, intent(in) :: parts             !! of the backstress
      real(wp), intent(in) :: dt               !! [time]
      type(plastic_past_type) :: past
      integer :: r

      past%strain = memory(strain_at(nstress))
      past%dt = dt
      r = temperature_at(nstress)
      past%radius = memory(r + 1)
      past%back(:, :parts) = reshape(memory(r + 11:r + 10 + 6*parts), [6, parts])
   end function plastic_past_of

   !> What it leaves, but for the plastic deformation.
   pure subroutine put_plastic(memory, nstress, parts, answer)
      real(wp), intent(inout) :: memory(:)
      integer, intent(in) :: nstress, parts
      type(plastic_answer_type), intent(in) :: answer
      integer :: r

      r = temperature_at(nstress)
      memory(strain_at(nstress)) = memory(strain_at(nstress)) + answer%step
      memory(stress_at(nstress)) = answer%along
      memory(work_at(nstress)) = memory(work_at(nstress)) + answer%work
      memory(r + 1) = answer%radius
      memory(r + 11:r + 10 + 6*parts) = reshape(answer%back(:, :parts), [6*parts])
   end subroutine put_plastic

   !> Write what a radial return leaves, but for the plastic deformation, and find its plastic work.
   pure subroutine put_return(memory, nstress, step, stress, work)
      real(wp), intent(inout) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: step             !! of plastic strain
      real(wp), intent(in) :: stress           !! von Mises, at the end [stress]
      real(wp), intent(out) :: work            !! per reference volume [stress]

      work = 0.5_wp*(memory(stress_at(nstress)) + stress)*step
      memory(strain_at(nstress)) = memory(strain_at(nstress)) + step
      memory(stress_at(nstress)) = stress
      memory(work_at(nstress)) = memory(work_at(nstress)) + work
   end subroutine put_return

   !> Inverse of the plastic deformation, - 1.
   pure function map_of(memory, nstress) result(map)
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp) :: map(3, 3)

      map = 0.0_wp
      if (size(memory) == 0) return
      map = reshape(memory(temperature_at(nstress) + 2:temperature_at(nstress) + 10), [3, 3])
   end function map_of

   !> Write it, and the metric that goes with it.
   pure subroutine put_map(memory, nstress, map)
      real(wp), intent(inout) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: map(3, 3)

      memory(temperature_at(nstress) + 2:temperature_at(nstress) + 10) = reshape(map, [9])
      call put_metric(memory, nstress, map + transpose(map) + matmul(map, transpose(map)))
   end subroutine put_map

   !> Row of the accumulated plastic strain [-].
   pure integer function strain_at(nstress)
      integer, intent(in) :: nstress
      strain_at = nstress + 1
   end function strain_at

   !> Row of the von Mises stress at the end of the last flow [stress].
   pure integer function stress_at(nstress)
      integer, intent(in) :: nstress
      stress_at = nstress + 2
   end function stress_at

   !> Row of the plastic work per reference volume [stress].
   pure integer function work_at(nstress)
      integer, intent(in) :: nstress
      work_at = nstress + 3
   end function work_at

   !> Amplitudes of the internal modes of an element, from the last two rows of all its points.
   pure function amplitudes_of(memory, nstress, nmode) result(alpha)
      real(wp), intent(in) :: memory(:, :)     !! (nmemory or 0, ngauss)
      integer, intent(in) :: nstress, nmode
      real(wp) :: alpha(nmode)
      integer :: m

      alpha = 0.0_wp
      if (size(memory, 1) == 0) return
      do m = 1, nmode
         alpha(m) = memory(work_at(nstress) + 1 + mod(m, 2), 1 + (m - 1)/2)
      end do
   end function amplitudes_of

   !> Write the amplitudes of internal modes, two a Gauss point.
   pure subroutine put_amplitudes(memory, nstress, alpha)
      real(wp), intent(inout) :: memory(:, :)  !! (nmemory, ngauss)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: alpha(:)
      integer :: m

      do m = 1, size(alpha)
         memory(work_at(nstress) + 1 + mod(m, 2), 1 + (m - 1)/2) = alpha(m)
      end do
   end subroutine put_amplitudes

   !> Row of what is added to ln J of the elastic part [-].
   pure integer function offset_at(nstress)
      integer, intent(in) :: nstress
      offset_at = nstress + 6
   end function offset_at

   !> What the law reads; from rest if the column is empty.
   pure function past_of(memory, nstress, dt) result(past)
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: dt               !! [time]
      type(past_type) :: past
      past%dt = dt
      if (size(memory) == 0) return
      past%strain = memory(strain_at(nstress))
      past%offset = memory(offset_at(nstress))
      if (size(memory) > memory_size(nstress)) past%temperature = memory(temperature_at(nstress))
   end function past_of

   !> The symmetric tensor that a point remembers.
   pure function metric_of(memory, nstress) result(metric)
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp) :: metric(3, 3)

      metric = 0.0_wp
      metric(1, 1) = memory(1)
      metric(2, 2) = memory(2)
      metric(3, 3) = memory(3)
      metric(1, 2) = memory(4)
      metric(2, 1) = memory(4)
      if (nstress == 4) return
      metric(1, 3) = memory(5)
      metric(3, 1) = memory(5)
      metric(2, 3) = memory(6)
      metric(3, 2) = memory(6)
   end function metric_of

   !> b - 1 of the elastic part if nothing flowed: F (1 + P) F^T - 1 with the metric P of a column.
   pure subroutine trial_change(h, memory, nstress, change)
      real(wp), intent(in) :: h(3, 3)          !! F - 1; in 2D z is a direction of its own
      real(wp), contiguous, intent(in) :: memory(:)   !! empty: P = 0
      integer, intent(in) :: nstress
      real(wp), intent(out) :: change(3, 3)
      real(wp) :: metric(3, 3)

      metric = 0.0_wp
      if (size(memory) > 0) metric = metric_of(memory, nstress)
      if (nstress == 4) then
         call push_in_plane(h, metric, change)
      else
         call push_in_space(h, metric, change)
      end if
   end subroutine trial_change

   pure subroutine push_in_space(h, metric, change)
      real(wp), intent(in) :: h(3, 3), metric(3, 3)
      real(wp), intent(out) :: change(3, 3)
      real(wp) :: half(3, 3)   ! F (1 + P) - 1
      integer :: i, j

      do j = 1, 3
         half(:, j) = h(:, j) + metric(:, j) + h(:, 1)*metric(1, j) + h(:, 2)*metric(2, j) &
            & + h(:, 3)*metric(3, j)
      end do
      do j = 1, 3
         do i = 1, j
            change(i, j) = half(i, j) + h(j, i) + half(i, 1)*h(j, 1) + half(i, 2)*h(j, 2) &
               & + half(i, 3)*h(j, 3)
            change(j, i) = change(i, j)
         end do
      end do
   end subroutine push_in_space

   pure subroutine push_in_plane(h, metric, change)
      real(wp), intent(in) :: h(3, 3), metric(3, 3)
      real(wp), intent(out) :: change(3, 3)
      real(wp) :: half(2, 2), across   ! F (1 + P) - 1
      integer :: j

      do j = 1, 2
         half(:, j) = h(:2, j) + metric(:2, j) + h(:2, 1)*metric(1, j) + h(:2, 2)*metric(2, j)
      end do
      across = h(3, 3) + metric(3, 3) + h(3, 3)*metric(3, 3)
      change = 0.0_wp
      do j = 1, 2
         change(:j, j) = half(:j, j) + h(j, :j) + half(:j, 1)*h(j, 1) + half(:j, 2)*h(j, 2)
      end do
      change(2, 1) = change(1, 2)
      change(3, 3) = across + h(3, 3) + across*h(3, 3)
   end subroutine push_in_plane

   !> Write the symmetric tensor that a point remembers.
   pure subroutine put_metric(memory, nstress, metric)
      real(wp), intent(inout) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: metric(3, 3)
      integer :: r

      do r = 1, nstress
         memory(r) = 0.5_wp*(metric(first_axis(r), second_axis(r)) &
            & + metric(second_axis(r), first_axis(r)))
      end do
   end subroutine put_metric
end module lopin_material_memory
