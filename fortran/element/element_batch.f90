!> Elements of one type and material in space that are computed at a time: the element is the
!> fastest index of every array.
module lopin_element_batch
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_kind, element_formulation
   use lopin_dilatation, only : dilatation_count
   use lopin_hyperelastic, only : solid_law_type, finite_law
   use lopin_enhanced_modes, only : most_modes
   use lopin_material_memory, only : strain_at, offset_at, amplitudes_of
   implicit none
   private
   public :: batch_type, kept_type, is_batchable, lanes, most, points, put_memory

   integer, parameter :: lanes = 8     !! elements of a batch
   integer, parameter :: most = 8      !! nodes
   integer, parameter :: points = 24   !! Gauss points where there are internal modes, else `most`

   !> Elements of a batch: what they are computed from, and the answers.
   type :: batch_type
      real(wp) :: x(lanes, 3, most)              !! coordinates [length]
      real(wp) :: u(lanes, 3, most)              !! displacements [length]
      real(wp) :: metric(lanes, 6, points)       !! plastic metric - 1, by Gauss point
      real(wp) :: strain(lanes, points)          !! plastic strain of the accepted state
      real(wp) :: offset(lanes, points)          !! elastic ln J beyond that of the deformation
      real(wp) :: amplitude(lanes, most_modes)   !! of internal modes, of the accepted state [-]
      real(wp) :: dt = 1.0_wp                    !! since the accepted state [time]
      real(wp) :: force(lanes, 3, most)          !! [force]
      real(wp) :: energy(lanes)                  !! [force length]
      real(wp) :: ke(lanes, 3, most, 3, most)    !! tangent: blocks of node a >= b [force/length]
   end type batch_type

   !> What the points of a batch keep of an increment.
   type :: kept_type
      real(wp) :: metric(lanes, 6, points)       !! added to the plastic metric
      real(wp) :: step(lanes, points)            !! of plastic strain
      real(wp) :: stress(lanes, points)          !! von Mises [stress]
      real(wp) :: weight(lanes, points)          !! reference volume
      real(wp) :: amplitude(lanes, most_modes)   !! of internal modes [-]
      real(wp) :: held(lanes)                    !! deformed volume of the element
   end type kept_type

contains

   !> Elements with straight edges in space whose law is Hencky's, with or without a radial return.
   pure logical function is_batchable(element, law)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law

      is_batchable = element%kind == element_kind%solid .and. element%nnode <= most &
         & .and. element%ngauss <= merge(points, most, element%nmode > 0) &
         & .and. element%nmode <= most_modes &
         & .and. .not. allocated(element%whole_weight) &
         & .and. element%formulation /= element_formulation%centre &
         & .and. dilatation_count(element) <= 1 .and. law%kind == finite_law%hencky &
         & .and. .not. allocated(law%plastic) .and. .not. allocated(law%flow%temperature)
   end function is_batchable

   !> What the points of the element in a lane remember; columns that are empty: nothing.
   pure subroutine put_memory(element, batch, lane, memory)
      type(element_type), intent(in) :: element
      type(batch_type), intent(inout) :: batch
      integer, intent(in) :: lane
      real(wp), contiguous, intent(in) :: memory(:, :)   !! (nmemory, ngauss)
      integer :: k

      batch%amplitude(lane, :element%nmode) = amplitudes_of(memory, 6, element%nmode)
      do k = 1, element%ngauss
         batch%metric(lane, :, k) = 0.0_wp
         batch%strain(lane, k) = 0.0_wp
         batch%offset(lane, k) = 0.0_wp
         if (size(memory, 1) == 0) cycle
         batch%metric(lane, :, k) = memory(:6, k)
         batch%strain(lane, k) = memory(strain_at(6), k)
         batch%offset(lane, k) = memory(offset_at(6), k)
      end do
   end subroutine put_memory
end module lopin_element_batch
