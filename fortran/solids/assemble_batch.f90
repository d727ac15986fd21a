!> Elements of one group, several at a time (module solid_batch), added to forces and tangent as one
!> by one: the same bits.
module lopin_assemble_batch
   use lopin_kinds, only : wp, ik
   use lopin_csc, only : csc_type
   use lopin_element_batch, only : batch_type, lanes, most, put_memory
   use lopin_batch_kernel, only : compute_batch
   use lopin_solid_configuration, only : configuration_type, share_type, take_nodes, add_nodes
   implicit none
   private
   public :: add_batch

   !> Elements from which on a batch, which computes all its lanes, takes less time than each alone.
   integer, parameter :: least = 3

contains

   !> Forces, energies and, if asked for, tangents of elements; not `done`: nothing is added.
   subroutine add_batch(shape, element, force, share, done, matrix)
      type(configuration_type), intent(in) :: shape
      integer, contiguous, intent(in) :: element(:)      !! of one batch of the solids
      real(wp), contiguous, intent(inout) :: force(:)
      type(share_type), contiguous, intent(inout) :: share(:)   !! (nelement)
      logical, intent(out) :: done
      type(csc_type), intent(inout), optional :: matrix
      type(batch_type) :: batch
      real(wp) :: own(3, 8)
      integer :: lane, e

      done = .false.
      if (.not. shape%memory%finite_strain .or. size(element) < least) return
      ! States of the start that count volumes otherwise are rare: one by one.
      if (shape%memory%scaled) return
      associate (self => shape%solids, group => shape%solids%group(shape%solids%which(element(1))))
         do lane = 1, lanes
            call fill_lane(shape, element(min(lane, size(element))), group%element%nnode, lane, &
               & batch)
         end do
         batch%dt = shape%memory%dt
         call compute_batch(group%element, group%law, present(matrix), batch, done)
         if (.not. done) return
         associate (nnode => group%element%nnode)
            do lane = 1, size(element)
               e = element(lane)
               own = batch%force(lane, :, :)
               share(e)%energy = batch%energy(lane)
               call add_nodes(shape, shape%mesh%conn(:nnode, e), own(:, :nnode), force, share(e))
               if (present(matrix)) call add_lane(3*nnode, lane, batch%ke, &
                  & self%slot(self%first_slot(e):self%first_slot(e + 1) - 1), matrix%value)
            end do
         end associate
      end associate
   end subroutine add_batch

   !> Nodes and memory of an element.
   subroutine fill_lane(shape, e, nnode, lane, batch)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e, nnode, lane
      type(batch_type), intent(inout) :: batch
      real(wp) :: x(3, nnode), moved(3, nnode)

      call take_nodes(shape, shape%mesh%conn(:nnode, e), x, moved)
      batch%x(lane, :, :nnode) = x
      batch%u(lane, :, :nnode) = moved
      associate (memory => shape%memory)
         if (shape%solids%group(shape%solids%which(e))%law%remembers) then
            call put_memory(batch, lane, memory%value(:, memory%first(e):memory%first(e + 1) - 1))
         else
            call put_memory(batch, lane, memory%none)
         end if
      end associate
   end subroutine fill_lane

   !> Add the lower triangle of the matrix of a lane to its slots; see add_slots of module solids.
   pure subroutine add_lane(ndof, lane, ke, slot, value)
      integer, intent(in) :: ndof, lane
      real(wp), intent(in) :: ke(lanes, 3*most, 3*most)
      integer(ik), contiguous, intent(in) :: slot(:)
      real(wp), contiguous, intent(inout) :: value(:)
      integer :: i, j, k

      k = 0
      do j = 1, ndof
         do i = j, ndof
            k = k + 1
            if (slot(k) > 0) then
               value(slot(k)) = value(slot(k)) + ke(lane, i, j)
            else if (slot(k) < 0) then
               value(-slot(k)) = value(-slot(k)) + 2.0_wp*ke(lane, i, j)
            end if
         end do
      end do
   end subroutine add_lane
end module lopin_assemble_batch
